#include "colmap_plugin/workspace/overlap_order.h"

#include <algorithm>
#include <utility>

namespace hpm {
namespace {

// Problems whose images are likely to be in memory still.
constexpr int kRecent = 10;
// Of one image, problems that are looked at. An image that more of them use
// tells little about which is near.
constexpr int kMostUsers = 64;

class Chain {
 public:
  explicit Chain(const std::vector<StereoProblem>& problems) {
    int num_images = 0;
    for (const StereoProblem& problem : problems) {
      std::vector<int> images = problem.wanted_sources;
      images.push_back(problem.ref_image);
      num_images = std::max(
          num_images, *std::max_element(images.begin(), images.end()) + 1);
      images_.push_back(std::move(images));
    }
    last_use_.assign(num_images, -kRecent);
    is_done_.assign(images_.size(), false);
    num_shared_.assign(images_.size(), 0);
    LinkUsers(num_images);
  }

  void Append(int problem) {
    is_done_[problem] = true;
    trail_.push_back(problem);
    ++num_done_;
    for (size_t j = 0; j < images_[problem].size(); ++j) {
      last_use_[images_[problem][j]] = num_done_;
      Unlink(first_node_[problem] + static_cast<int>(j));
    }
  }

  // Of those that are not done; there must be one.
  int Next() {
    for (; !trail_.empty(); trail_.pop_back()) {
      const int next = BestAfter(trail_.back());
      if (next >= 0) return next;
    }
    while (is_done_[first_open_]) ++first_open_;
    return first_open_;
  }

 private:
  // The list of the problems that use an image and are not done, in their
  // order. There is a node for each image of each problem, and a head for each
  // image behind them.
  struct Node {
    int problem = -1;
    int next = -1;
    int previous = -1;
  };

  void LinkUsers(int num_images) {
    int num_nodes = 0;
    for (const std::vector<int>& images : images_) {
      first_node_.push_back(num_nodes);
      num_nodes += static_cast<int>(images.size());
    }
    heads_ = num_nodes;
    nodes_.resize(num_nodes + num_images);
    for (int p = static_cast<int>(images_.size()) - 1; p >= 0; --p) {
      for (size_t j = 0; j < images_[p].size(); ++j) {
        const int node = first_node_[p] + static_cast<int>(j);
        const int head = heads_ + images_[p][j];
        nodes_[node] = {p, nodes_[head].next, head};
        if (nodes_[node].next >= 0) nodes_[nodes_[node].next].previous = node;
        nodes_[head].next = node;
      }
    }
  }

  void Unlink(int node) {
    nodes_[nodes_[node].previous].next = nodes_[node].next;
    if (nodes_[node].next >= 0)
      nodes_[nodes_[node].next].previous = nodes_[node].previous;
  }

  // -1 if nothing that is left shares an image with the problem.
  int BestAfter(int problem) {
    std::vector<int> candidates;
    for (const int image : images_[problem]) {
      int node = nodes_[heads_ + image].next;
      for (int i = 0; i < kMostUsers && node >= 0; ++i) {
        const int user = nodes_[node].problem;
        if (num_shared_[user]++ == 0) candidates.push_back(user);
        node = nodes_[node].next;
      }
    }
    int best = -1, best_shared = 0, best_recent = 0;
    for (const int p : candidates) {
      const int shared = std::exchange(num_shared_[p], 0);
      if (shared < best_shared) continue;
      const int recent = NumRecent(p);
      if (shared == best_shared &&
          (recent < best_recent || (recent == best_recent && p > best)))
        continue;
      best = p;
      best_shared = shared;
      best_recent = recent;
    }
    return best;
  }

  int NumRecent(int problem) const {
    return static_cast<int>(std::count_if(
        images_[problem].begin(), images_[problem].end(), [this](int image) {
          return last_use_[image] > num_done_ - kRecent;
        }));
  }

  std::vector<std::vector<int>> images_;  // by problem
  std::vector<int> first_node_;           // by problem
  std::vector<bool> is_done_;             // by problem
  std::vector<int> num_shared_;           // by problem, 0 between two calls
  std::vector<int> last_use_;  // by image, number of the problem in the chain
  std::vector<Node> nodes_;
  int heads_ = 0;           // index of the first head in nodes_
  std::vector<int> trail_;  // problems done from which the chain may go on
  int num_done_ = 0;
  int first_open_ = 0;  // all problems before are done
};

}  // namespace

void OrderByOverlap(std::vector<StereoProblem>* problems, size_t begin) {
  Chain chain(*problems);
  for (size_t p = 0; p < begin; ++p) chain.Append(static_cast<int>(p));
  std::vector<StereoProblem> ordered;
  for (size_t i = begin; i < problems->size(); ++i) {
    const int next = chain.Next();
    chain.Append(next);
    ordered.push_back(std::move((*problems)[next]));
  }
  std::move(ordered.begin(), ordered.end(), problems->begin() + begin);
}

}  // namespace hpm
