#include "colmap_plugin/workspace/automatic_sources.h"

#include <algorithm>

namespace hpm {

AutomaticSources::AutomaticSources(const Workspace& workspace,
                                   const TrackIndex& tracks,
                                   const SeenPoints& seen,
                                   const CancelToken& cancel)
    : workspace_(workspace),
      selector_(workspace, tracks),
      overlap_(seen),
      cancel_(cancel) {
  for (int i = 0; i < workspace.num_images(); ++i) {
    cancel.ThrowIfCancelled();
    all_.push_back(i);
    is_badly_tracked_.push_back(!selector_.SharesPoints(i, kEnoughPoints));
    if (is_badly_tracked_.back()) badly_tracked_.push_back(i);
  }
}

std::vector<std::vector<SourceCandidate>> AutomaticSources::Sharing(
    const std::vector<int>& ref_images,
    double min_angle,
    const std::function<void()>& on_image) const {
  return selector_.CandidatesOf(ref_images, min_angle, cancel_, on_image);
}

std::vector<int> AutomaticSources::Best(
    int ref_image,
    const std::vector<SourceCandidate>& sharing,
    const std::optional<DepthRange>& range,
    double min_angle,
    size_t max_num) const {
  if (max_num == 0) return {};
  std::vector<int> sources = SelectWideEnough(sharing, /*max_num=*/-1);
  // Images whose tracks tell too little are not missed by others, either.
  AddOverlapping(ref_image,
                 range,
                 min_angle,
                 is_badly_tracked_[ref_image] ? all_ : badly_tracked_,
                 max_num,
                 &sources);
  return sources;
}

std::vector<int> AutomaticSources::All(
    int ref_image,
    const std::vector<SourceCandidate>& sharing,
    const std::optional<DepthRange>& range) const {
  std::vector<int> sources;
  sources.reserve(sharing.size());
  for (const SourceCandidate& candidate : sharing)
    sources.push_back(candidate.image);
  if (is_badly_tracked_[ref_image]) {
    AddOverlapping(
        ref_image, range, /*min_angle=*/0, all_, all_.size(), &sources);
  }
  std::vector<bool> taken(workspace_.num_images(), false);
  taken[ref_image] = true;
  for (const int source : sources) taken[source] = true;
  for (int i = 0; i < workspace_.num_images(); ++i) {
    if (!taken[i] && workspace_.usable(i)) sources.push_back(i);
  }
  return sources;
}

bool AutomaticSources::SharesPoints(int image) const {
  return selector_.SharesPoints(image, 1);
}

// Behind those that share points, until max_num have a picture.
void AutomaticSources::AddOverlapping(int ref,
                                      const std::optional<DepthRange>& range,
                                      double min_angle,
                                      const std::vector<int>& candidates,
                                      size_t max_num,
                                      std::vector<int>* sources) const {
  auto num_with_picture = static_cast<size_t>(
      std::count_if(sources->begin(), sources->end(), [this](int i) {
        return workspace_.has_picture(i);
      }));
  if (!range || num_with_picture >= max_num) return;
  for (const int image : overlap_.Select(ref, *range, min_angle, candidates)) {
    if (num_with_picture >= max_num) break;
    if (std::find(sources->begin(), sources->end(), image) != sources->end())
      continue;
    sources->push_back(image);
    num_with_picture += workspace_.has_picture(image);
  }
}

void TakeThoseWithPictures(const Workspace& workspace,
                           size_t max_num,
                           std::vector<int>* images) {
  const auto without = [&](int i) { return !workspace.has_picture(i); };
  images->erase(std::remove_if(images->begin(), images->end(), without),
                images->end());
  if (images->size() > max_num) images->resize(max_num);
}

}  // namespace hpm
