# Somebody else's project.
cmake_minimum_required(VERSION 3.22)
project(consumer LANGUAGES CXX)
find_package(hpm_mvs 0.1 REQUIRED)
add_executable(consumer consumer.cc)
target_compile_features(consumer PRIVATE cxx_std_17)
target_link_libraries(consumer PRIVATE hpm_mvs::controller hpm_mvs::cpu)
