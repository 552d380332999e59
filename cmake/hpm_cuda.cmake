# Decides whether the CUDA backend is built; sets HPM_HAS_CUDA. Machine code for the
# cards of compute capability 7.5 to 9.0, PTX for all later ones; the runtime is linked
# statically and loads the driver when it is first used, so the same program runs on
# machines without one.
include_guard()

set(HPM_HAS_CUDA OFF)
if(NOT HPM_CUDA STREQUAL "OFF")
  find_program(HPM_NVCC nvcc HINTS $ENV{CUDA_HOME}/bin $ENV{CUDA_PATH}/bin /usr/local/cuda/bin)
  if(HPM_NVCC)
    set(CMAKE_CUDA_COMPILER ${HPM_NVCC})
    if(NOT DEFINED CMAKE_CUDA_ARCHITECTURES)
      set(CMAKE_CUDA_ARCHITECTURES 75-real 80-real 86-real 89-real 90
          CACHE STRING "GPU architectures; a number without -real also gives PTX")
    endif()
    enable_language(CUDA)
    set(CMAKE_CUDA_STANDARD 17)
    set(CMAKE_CUDA_STANDARD_REQUIRED ON)
    set(CMAKE_CUDA_EXTENSIONS OFF)
    find_package(CUDAToolkit REQUIRED)
    set(HPM_HAS_CUDA ON)
    message(STATUS "CUDA backend: on, nvcc ${CMAKE_CUDA_COMPILER_VERSION}, ${CMAKE_CUDA_ARCHITECTURES}")
  elseif(HPM_CUDA STREQUAL "ON")
    message(FATAL_ERROR "HPM_CUDA=ON, but nvcc is not found; put it on the PATH or set CUDA_HOME")
  else()
    message(STATUS "CUDA backend: off, nvcc is not found")
  endif()
endif()
