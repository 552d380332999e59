// The two encodings of a sparse model, each file feeding the builder.
// Layouts: COLMAP's documentation, "Output format".
#pragma once

#include "colmap_plugin/formats/sparse_model_builder.h"

namespace hpm {

void ReadCamerasBinary(const std::filesystem::path& path,
                       SparseModelBuilder* builder);
void ReadImagesBinary(const std::filesystem::path& path,
                      SparseModelBuilder* builder);
void ReadRigsBinary(const std::filesystem::path& path,
                    SparseModelBuilder* builder);
void ReadFramesBinary(const std::filesystem::path& path,
                      SparseModelBuilder* builder);
void ReadPointsBinary(const std::filesystem::path& path,
                      SparseModelBuilder* builder);

void ReadCamerasText(const std::filesystem::path& path,
                     SparseModelBuilder* builder);
void ReadImagesText(const std::filesystem::path& path,
                    SparseModelBuilder* builder);
void ReadRigsText(const std::filesystem::path& path,
                  SparseModelBuilder* builder);
void ReadFramesText(const std::filesystem::path& path,
                    SparseModelBuilder* builder);
void ReadPointsText(const std::filesystem::path& path,
                    SparseModelBuilder* builder);

}  // namespace hpm
