# Included by the top CMakeLists.txt of a patched COLMAP that is configured with
# -DHPM_MVS_DIR=<this tree>: builds our library as part of COLMAP and joins it to
# COLMAP's own.
include_guard()

if(DEFINED MVS_ENABLED AND NOT MVS_ENABLED)
  message(FATAL_ERROR "HPM_MVS_DIR is given but MVS_ENABLED is off; switch it on")
endif()

# The library of COLMAP that holds the dense step, and those that call it. All in one in
# 3.8. Later ones forbid libraries that need each other, so ours comes between the two.
set(hpm_colmap_library colmap)
set(hpm_colmap_callers colmap)
if(EXISTS ${PROJECT_SOURCE_DIR}/src/colmap/mvs)
  set(hpm_colmap_library colmap_mvs)
  set(hpm_colmap_callers colmap_controllers colmap_exe colmap_ui)
endif()

# For all of COLMAP, as not all of it that sees mvs/patch_match.h links that library publicly.
add_compile_definitions(HPM_MVS_ENABLED)
include_directories($<BUILD_INTERFACE:${HPM_MVS_DIR}>)

set(HPM_TESTS OFF CACHE INTERNAL "")
set(HPM_BENCH OFF CACHE INTERNAL "")
# A language switched on in a subfolder does not reach the top of the build.
set(HPM_CUDA OFF CACHE INTERNAL "")
add_subdirectory(${HPM_MVS_DIR} ${CMAKE_BINARY_DIR}/hpm_mvs EXCLUDE_FROM_ALL)

# Ours are linked privately, since our compile options are not COLMAP's.
add_library(hpm_in_colmap STATIC
  ${HPM_MVS_DIR}/colmap_plugin/in_colmap/patch_match_controller.cc
  ${HPM_MVS_DIR}/colmap_plugin/in_colmap/subcommand.cc)
set_target_properties(hpm_in_colmap PROPERTIES
  CXX_STANDARD 17 CXX_STANDARD_REQUIRED ON POSITION_INDEPENDENT_CODE ON)
# COLMAP's headers do not keep our stricter warnings.
target_compile_options(hpm_in_colmap PRIVATE -Wno-shadow -Wno-unused-parameter)
target_link_libraries(hpm_in_colmap
  PUBLIC ${hpm_colmap_library}
  PRIVATE hpm_process)

# By property, as COLMAP's versions call target_link_libraries in two ways that do not
# mix. Only in this build: COLMAP's installed CMake package does not know us.
function(hpm_join_colmap)
  foreach(caller IN LISTS hpm_colmap_callers)
    if(TARGET ${caller})
      set_property(TARGET ${caller} APPEND PROPERTY
        LINK_LIBRARIES $<BUILD_INTERFACE:hpm_in_colmap>)
      set_property(TARGET ${caller} APPEND PROPERTY
        INTERFACE_LINK_LIBRARIES $<BUILD_INTERFACE:hpm_in_colmap>)
    endif()
  endforeach()
  if(TARGET colmap_mvs_cuda)
    target_link_libraries(hpm_in_colmap PRIVATE colmap_mvs_cuda)
  endif()
endfunction()
cmake_language(DEFER CALL hpm_join_colmap)
