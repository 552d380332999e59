# OpenCV's core, imgproc and imgcodecs as targets opencv_core, opencv_imgproc and
# opencv_imgcodecs. Debian keeps OpenCVConfig.cmake in libopencv-dev, which pulls in
# every module; the small -dev packages have only headers and libraries, so these
# are looked for directly when the package file is absent.
include_guard()

find_package(OpenCV 4 QUIET COMPONENTS core imgproc imgcodecs)
if(NOT OpenCV_FOUND)
  find_path(HPM_OPENCV_INCLUDE_DIR opencv2/core.hpp PATH_SUFFIXES opencv4)
  foreach(module core imgproc imgcodecs)
    find_library(HPM_OPENCV_${module}_LIBRARY opencv_${module})
    if(NOT HPM_OPENCV_INCLUDE_DIR OR NOT HPM_OPENCV_${module}_LIBRARY)
      message(FATAL_ERROR "OpenCV's ${module} module is missing; run scripts/install_dependencies.sh")
    endif()
    add_library(opencv_${module} UNKNOWN IMPORTED GLOBAL)
    set_target_properties(opencv_${module} PROPERTIES
      IMPORTED_LOCATION "${HPM_OPENCV_${module}_LIBRARY}"
      INTERFACE_INCLUDE_DIRECTORIES "${HPM_OPENCV_INCLUDE_DIR}")
  endforeach()
  target_link_libraries(opencv_imgproc INTERFACE opencv_core)
  target_link_libraries(opencv_imgcodecs INTERFACE opencv_imgproc)
endif()
