// src/core is compiled by the C++ compiler and by nvcc: PODs and inline
// functions only, no Eigen, no containers, no exceptions, no virtual calls.
#pragma once

#if defined(__CUDACC__)
#define HPM_HD __host__ __device__ inline
#define HPM_HD_MEMBER __host__ __device__
#else
#define HPM_HD inline
#define HPM_HD_MEMBER
#endif
