// Long work beside Python: it runs in a thread of its own without the GIL, and
// the calling thread meanwhile looks out for signals and handles what the work
// has to say. So callbacks are called in the thread that called us.
#pragma once

#include "src/base/cancel.h"

#include <functional>

namespace hpm {

// Hands a piece of work to the calling thread, which does it with the GIL. From
// any thread; must hold no Python object of its own.
using Post = std::function<void(std::function<void()>)>;

// Called with the GIL; returns when the work has ended. What a signal (Ctrl-C)
// or a posted piece raises cancels the work and is thrown in the end, else what
// the work throws: an Error in any case.
void RunInBackground(
    const std::function<void(const CancelToken&, const Post&)>& work);

}  // namespace hpm
