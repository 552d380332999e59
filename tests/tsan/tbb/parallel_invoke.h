// See parallel_for.h in this folder.
#pragma once

#include <tbb/parallel_for.h>

namespace tbb {

template <class First, class Second>
void parallel_invoke(const First& first, const Second& second) {
  parallel_for(0, 2, [&](int i) {
    if (i == 0) {
      first();
    } else {
      second();
    }
  });
}

}  // namespace tbb
