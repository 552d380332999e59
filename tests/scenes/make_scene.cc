// hpm_make_scene NAME FOLDER: writes a closed-form scene as a COLMAP dense
// workspace.
#include "bench/eval/program.h"
#include "tests/scenes/workspace_writer.h"

int main(int argc, char** argv) {
  namespace po = boost::program_options;
  std::string name, folder, truth_stage;
  hpm::SceneOptions options;
  po::options_description table;
  // clang-format off
  table.add_options()
      ("name", po::value(&name)->required(),
       "tilted_plane, depth_step, sphere, low_texture_wall or corridor (first word)")
      ("folder", po::value(&folder)->required(), "where the workspace goes (second word)")
      ("views", po::value(&options.num_views)->default_value(options.num_views), "images")
      ("width", po::value(&options.width)->default_value(options.width), "pixels")
      ("height", po::value(&options.height)->default_value(options.height), "pixels")
      ("quarter_turns", po::value(&options.quarter_turns)->multitoken(),
       "roll of the cameras in quarter turns, repeated")
      ("truth_stage", po::value(&truth_stage),
       "also write the truth as finished maps of this stage, e.g. geometric");
  // clang-format on
  po::positional_options_description positional;
  positional.add("name", 1).add("folder", 1);
  return hpm::RunProgram(
      argc,
      argv,
      "Writes a closed-form test scene as a COLMAP dense workspace.",
      table,
      positional,
      [&](const po::variables_map&) {
        const hpm::TestScene scene = hpm::MakeScene(name, options);
        hpm::WriteWorkspace(scene, folder);
        if (!truth_stage.empty()) {
          hpm::WriteTruthAsMaps(scene, folder, truth_stage);
        }
      });
}
