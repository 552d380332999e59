#include "bench/eval/program.h"

#include "src/base/error.h"

#include <iostream>

namespace hpm {

namespace po = boost::program_options;

int RunProgram(int argc,
               char** argv,
               const char* summary,
               po::options_description options,
               const po::positional_options_description& positional,
               const std::function<void(const po::variables_map&)>& run) {
  options.add_options()("help,h", "print this text");
  try {
    po::variables_map values;
    po::store(po::command_line_parser(argc, argv)
                  .options(options)
                  .positional(positional)
                  .run(),
              values);
    if (values.count("help") > 0) {
      std::cout << summary << "\n\n" << options;
      return 0;
    }
    po::notify(values);
    run(values);
    return 0;
  } catch (const Error& error) {
    std::cerr << "error: " << error.what() << "\n";
    return static_cast<int>(error.code());
  } catch (const po::error& error) {
    std::cerr << "error: " << error.what() << "; see --help\n";
    return static_cast<int>(ErrorCode::kUsage);
  } catch (const std::exception& error) {
    std::cerr << "error: " << error.what() << "\n";
    return static_cast<int>(ErrorCode::kFailure);
  }
}

}  // namespace hpm
