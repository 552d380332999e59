// Sources that see the scene in finer detail than the reference.
#pragma once

#include "colmap_plugin/workspace/problem.h"
#include "colmap_plugin/workspace/workspace.h"

namespace hpm {

// How many times more than the reference a source image is halved. The matching
// cost takes one sample of the source per pixel of the reference; where the
// source is zoomed in, larger or nearer, its pixels are so much smaller on the
// surface that single ones say nothing about what the reference averages over.
// Depends on nothing but cameras and the depths to search.
int SourceLevel(const Workspace& workspace,
                const StereoProblem& problem,
                int src_image);

}  // namespace hpm
