// Processes and the machine they run on, as far as the system tells.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace hpm {

int64_t ThisProcessId();

// Where the program that runs lies; empty where the system does not say.
std::filesystem::path ThisProgram();

// Runs another program in place of this one, with the arguments argv[1], ...
// Returns only where that fails: -1 and errno. Windows cannot replace a
// program: there the other one is waited for and its exit code returned.
int ReplaceThisProgram(const std::filesystem::path& program, char** argv);

#ifdef _WIN32
constexpr char kSearchPathSeparator = ';';
constexpr const char* kProgramSuffix = ".exe";
#else
constexpr char kSearchPathSeparator = ':';
constexpr const char* kProgramSuffix = "";
#endif

// May be run: exists and is executable.
bool IsExecutable(const std::filesystem::path& path);

// The name of the machine; empty where unknown.
std::string HostName();
// Another one after every start of the machine; empty where unknown.
std::string BootId();
// Process ids have a meaning only within it; empty where there is but one.
std::string ProcessNamespace();

enum class ProcessState { kGone, kEnded, kAlive };

struct ProcessStatus {
  // kEnded: its parent has not asked for its exit code yet. kAlive where the
  // system does not say.
  ProcessState state = ProcessState::kGone;
  // In units of the system, tells processes with the same id apart; 0 where
  // unknown.
  uint64_t start_time = 0;
};
ProcessStatus StatusOfProcess(int64_t id);

}  // namespace hpm
