#include "python/src/progress.h"

#include "src/base/error.h"

#include <nanobind/stl/string.h>

namespace nb = nanobind;

namespace hpm {

void BindProgress(nb::module_& module) {
  nb::class_<ProgressEvent>(
      module,
      "ProgressEvent",
      "How far a run is; comes at its start, after every finished part of an "
      "image and at\nthe end of a stage.")
      .def_ro("stage",
              &ProgressEvent::stage,
              "\"photometric\", \"geometric 1/2\", ...")
      .def_ro("title", &ProgressEvent::title, "The stage, for people")
      .def_ro("image",
              &ProgressEvent::image,
              "Reference image worked on; empty at the end of a stage")
      .def_ro("image_number",
              &ProgressEvent::image_number,
              "From 1, within the stage")
      .def_ro("num_images", &ProgressEvent::num_images, "Of the stage")
      .def_ro("fraction",
              &ProgressEvent::fraction,
              "Of the whole run, 0 to 1, by estimated work")
      .def("__repr__", [](const ProgressEvent& event) {
        return nb::str("ProgressEvent({:.1%}, {!r}, {!r})")
            .attr("format")(event.fraction, event.title, event.image);
      });
}

void CheckCallback(nb::handle callback) {
  if (callback.is_none() || PyCallable_Check(callback.ptr())) return;
  throw Error(
      ErrorCode::kUsage,
      "progress: it is called with a ProgressEvent, so give a function");
}

ProgressSink ProgressTo(nb::handle callback, const Post& post) {
  if (callback.ptr() == Py_None) return [](const ProgressEvent&) {};
  return [callback, post](const ProgressEvent& event) {
    post([callback, event] { callback(event); });
  };
}

}  // namespace hpm
