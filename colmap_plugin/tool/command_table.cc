#include "colmap_plugin/tool/command_table.h"

#include <utility>

namespace hpm {
namespace {

template <class T>
CommandOption Row(std::string name,
                  T CommandOptions::*member,
                  Allowed allowed,
                  std::string help) {
  return {std::move(name),
          [member](CommandOptions* options) {
            return OptionMember(&(options->*member));
          },
          std::move(allowed),
          std::move(help)};
}

template <class T>
CommandOption ExportRow(std::string name,
                        T ExportOptions::*member,
                        Allowed allowed,
                        std::string help) {
  return {std::move(name),
          [member](CommandOptions* options) {
            return OptionMember(&(options->export_maps.*member));
          },
          std::move(allowed),
          std::move(help)};
}

std::vector<Command> MakeTable() {
  using C = CommandOptions;
  using E = ExportOptions;
  return {
      // A table reads better packed.
      // clang-format off
      {"patch_match_stereo", "Compute the depth and normal maps of a workspace",
       "", "", TakesOptions::kAll, {}},
      {"plan", "Say what a run would do, how long it takes and what would stop it, without running",
       "Makes all checks that a run makes, and names all problems at once, not only the first: options, workspace, "
       "model, images, masks, patch-match.cfg, folders, disk, memory, device. Then: images and sources, working size, "
       "disk and memory, what is kept from an earlier run, and a time: that of reading and planning, and what follows "
       "from one image computed at a reduced size, in the folder for temporary files. Changes nothing in the workspace. "
       "Give the options of the run.",
       "that of the run: 0 nothing stops it, 4 some images cannot be computed",
       TakesOptions::kAll,
       {Row("sample_seconds", &C::sample_seconds, Between(0, 3600),
            "How long to measure for the time; 0: say no time")}},
      {"check", "Validate all maps of a workspace and name those that are damaged, unreadable, stale, unstamped, foreign or missing",
       "Reads every depth map, normal map, consistency graph and stamp: header and length, checksum, finite "
       "values, depths that are not negative and inside a range given by hand, normals of length one, and the "
       "size that the image has in the run. Give the options of the run: maps made with others are stale. Each "
       "finding is one line: 'damaged' is of no use to anybody; 'unreadable' may be good, but the disk or the "
       "permissions do not let it be read; 'stale' was made with other options, from other images or by another "
       "version; 'unstamped' was made by another program, or by a run that was stopped just then; 'foreign' is a "
       "file that the run does not make; 'missing' is what the next run makes. Nothing is changed without --fix 1.",
       "0 all is there and good, 3 something is damaged or unreadable, 4 neither, but the next run has something to do",
       TakesOptions::kAll,
       {Row("fix", &C::fix, Anything(),
            "Remove what is damaged; the next run makes it anew, and what it needs for that; all else stays")}},
      {"report", "Write a page about a workspace's maps: pictures, why pixels were dropped, times, warnings",
       "One HTML file that needs nothing else, made of the maps, their stamps and the record of the last run: image, "
       "depth and normals side by side, the share of pixels with a depth and their matching costs, what took "
       "the others, sources and the points they share, the depth range beside that of the sparse points, time and memory, options, warnings with "
       "remedies; a click on a heading sorts. A run writes it at its end unless --Hpm.report 0 is given. Give the "
       "options of the run.",
       "0 done, also where maps are missing",
       TakesOptions::kAll,
       {Row("output_path", &C::report_path, Anything(), "The file; not given: stereo/report.html")}},
      {"export", "Write finished maps as EXR, PFM, 16-bit PNG, NPY or as a coloured cloud (PLY) per image",
       "Writes IMAGE.depth.EXT and IMAGE.normal.EXT, and IMAGE.json, which holds the camera and what the numbers "
       "mean: depth is z in the camera's frame in model units, 0 where there is none; normals are unit vectors in "
       "the camera's frame. ply: IMAGE.ply, the points of this one image in the model's frame, with colours and "
       "normals, for a quick look without fusion. exr: one channel Y or three, R G B = x y z, 32-bit float. "
       "png16: depth in steps of depth_per_step, 0 = none; normals as 32768 + 32767 n. Where there is a confidence map, "
       "IMAGE.confidence.EXT, too, in png16 as 65535 times the probability.",
       "0 done, 3 there are no such maps, 4 some maps are damaged, the others are written",
       TakesOptions::kWorkspace,
       {ExportRow("format", &E::format, OneOf({"exr", "pfm", "png16", "npy", "ply"}), "Kind of files"),
        ExportRow("image_name", &E::image_name, Anything(),
                  "Only this image, named as in the sparse model; not given: all that have maps"),
        ExportRow("input_type", &E::input_type, OneOf({"geometric", "photometric"}),
                  "Which maps, as in stereo_fusion"),
        ExportRow("output_path", &E::output_path, Anything(), "Folder for the files; not given: stereo/export, of photometric maps stereo/export_photometric"),
        ExportRow("depth_step", &E::depth_step, AtLeast(0),
                  "png16: model units per step; 0: each image's largest depth becomes 65535")}},
      {"status", "Tell how far a workspace is: what each stage has finished and still needs",
       "Plans as a run with the same options would and looks at all maps, without changing anything. A stage's maps "
       "are finished when they are good or of no use any more; needed: a run would make them, be it that they are "
       "missing, damaged, incomplete (made without the maps of a source) or stale (made with other options or "
       "inputs).",
       "0 complete, 4 complete but for images that cannot be computed, 8 something is needed",
       TakesOptions::kAll,
       {Row("verify", &C::verify, Anything(),
            "Read all maps and compare their checksums, also where length and time are those they were written with"),
        Row("format", &C::format, OneOf({"text", "json"}),
            "json: one line with complete, failing, and stages in order, each with name and counts")}},
      {"help", "Print this text; help COMMAND: what a command does and takes; help --markdown, --man, --bash: as a "
       "document, manual page, completion", "", "", TakesOptions::kNone, {}},
      {"version", "Print the version", "", "", TakesOptions::kNone, {}},
      // clang-format on
  };
}

}  // namespace

const std::vector<Command>& CommandTable() {
  static const std::vector<Command> table = MakeTable();
  return table;
}

const Command* FindCommand(std::string_view name) {
  for (const Command& command : CommandTable()) {
    if (command.name == name) return &command;
  }
  return nullptr;
}

std::string CommandNames(const char* separator) {
  std::string names;
  for (const Command& command : CommandTable())
    names += (names.empty() ? "" : separator) + command.name;
  return names;
}

bool Takes(const Command& command, const OptionSpec& option) {
  if (command.takes != TakesOptions::kWorkspace)
    return command.takes == TakesOptions::kAll;
  for (const char* name :
       {"workspace_path", "workspace_format", "pmvs_option_name"}) {
    if (option.name == name) return true;
  }
  return false;
}

std::string DefaultText(const CommandOption& option) {
  CommandOptions defaults;
  return FormatValue(option.member(&defaults));
}

std::string TypeText(const CommandOption& option) {
  CommandOptions defaults;
  return TypeName(option.member(&defaults));
}

std::string AllowedText(const CommandOption& option) {
  const std::string type = TypeText(option);
  if (type == "bool") return "0/1, true/false, yes/no or on/off";
  return option.allowed.text.empty() ? type : type + ", " + option.allowed.text;
}

}  // namespace hpm
