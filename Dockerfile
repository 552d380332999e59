# hpm_mvs with COLMAP beside it, in an image of its own.
#
# CPU:   docker build -t hpm-mvs .
# CUDA:  docker build -t hpm-mvs:cuda \
#          --build-arg BUILD_IMAGE=nvidia/cuda:12.6.3-devel-ubuntu24.04 \
#          --build-arg RUN_IMAGE=nvidia/cuda:12.6.3-base-ubuntu24.04 .
# Run:   docker run --rm [--gpus all] -v "$PWD/dense:/dense" hpm-mvs \
#          patch_match_stereo --workspace_path /dense
# `colmap` inside is the wrapper: its patch_match_stereo is ours too.
ARG BUILD_IMAGE=debian:12
ARG RUN_IMAGE=debian:12-slim

FROM ${BUILD_IMAGE} AS build
ENV DEBIAN_FRONTEND=noninteractive
WORKDIR /hpm_mvs
COPY scripts/install_dependencies.sh scripts/
RUN scripts/install_dependencies.sh && apt-get install -y --no-install-recommends dpkg-dev file
COPY . .
RUN cmake -S . -B build/package -G Ninja -DCMAKE_BUILD_TYPE=Release \
      -DHPM_TESTS=OFF -DHPM_BENCH=OFF \
    && cmake --build build/package \
    && cd build/package && cpack -G DEB

FROM ${RUN_IMAGE}
ENV DEBIAN_FRONTEND=noninteractive
COPY --from=build /hpm_mvs/build/package/hpm-mvs_*.deb /tmp/
RUN apt-get update \
    && apt-get install -y --no-install-recommends /tmp/hpm-mvs_*.deb colmap \
    && rm -rf /tmp/hpm-mvs_*.deb /var/lib/apt/lists/*
ENV PATH=/usr/libexec/hpm_mvs/bin:$PATH QT_QPA_PLATFORM=offscreen
ENTRYPOINT ["hpm_mvs"]
CMD ["help"]
