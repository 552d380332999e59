// A picture of a fused cloud, seen from one of the cameras of its sparse model.
#include "bench/eval/model_camera.h"
#include "bench/eval/ply.h"
#include "bench/eval/program.h"
#include "bench/eval/splat.h"
#include "src/base/error.h"

#include <cmath>

#include <opencv2/imgcodecs.hpp>

namespace hpm {
namespace {

const SparseImage& FindImage(const SparseModel& model,
                             const std::string& name) {
  for (const SparseImage& image : model.images) {
    if (image.name == name) return image;
  }
  throw Error(ErrorCode::kUsage, "the sparse model has no image named " + name);
}

}  // namespace
}  // namespace hpm

int main(int argc, char** argv) {
  namespace po = boost::program_options;
  std::string cloud, sparse, image_name, output;
  int width = 0, point_size = 0;
  po::options_description table;
  // clang-format off
  table.add_options()
      ("cloud", po::value(&cloud)->required(), "PLY (first word)")
      ("sparse", po::value(&sparse)->required(), "folder of the sparse model (second word)")
      ("image", po::value(&image_name)->required(), "name of the image to look from (third word)")
      ("output", po::value(&output)->required(), "PNG (fourth word)")
      ("width", po::value(&width)->default_value(800), "pixels")
      ("point_size", po::value(&point_size)->default_value(3), "pixels");
  // clang-format on
  po::positional_options_description positional;
  positional.add("cloud", 1).add("sparse", 1).add("image", 1).add("output", 1);
  return hpm::RunProgram(
      argc,
      argv,
      "Draws a point cloud from a camera of the sparse model.",
      table,
      positional,
      [&](const po::variables_map&) {
        if (width < 1 || width > 16384 || point_size < 1 || point_size > 64) {
          throw hpm::Error(hpm::ErrorCode::kUsage,
                           "--width must be 1..16384 and --point_size 1..64");
        }
        const hpm::SparseModel model = hpm::ReadSparseModel(sparse);
        const hpm::SparseImage& image = hpm::FindImage(model, image_name);
        const auto camera = model.cameras.find(image.camera_id);
        if (camera == model.cameras.end() || camera->second.width == 0) {
          throw hpm::Error(hpm::ErrorCode::kBadInput,
                           image_name + ": its camera is missing");
        }
        const double aspect = static_cast<double>(camera->second.height) /
                              static_cast<double>(camera->second.width);
        const int height = static_cast<int>(std::lround(width * aspect));
        const cv::Mat picture =
            hpm::SplatCloud(hpm::ReadPly(cloud),
                            hpm::ModelCamera(model, image, width, height),
                            point_size);
        if (!cv::imwrite(output, picture)) {
          throw hpm::Error(hpm::ErrorCode::kFailure,
                           output + ": cannot be written");
        }
      });
}
