# Schuler in a container: docker build -t schuler . && docker run --rm -v "$PWD:/data" schuler process /data/LOGS -o /data/out
FROM debian:12 AS build
COPY scripts/packages.sh /src/scripts/packages.sh
RUN apt-get update && apt-get install --yes --no-install-recommends $(/src/scripts/packages.sh --list build) \
        python3-dev pybind11-dev python3-numpy python3-setuptools fakeroot dpkg-dev git
COPY . /src
ARG SOURCE_DATE_EPOCH=0
ARG SCHULER_COMMIT=
RUN cmake -S /src -B /build -G Ninja -DCMAKE_BUILD_TYPE=Release -DSCHULER_TESTS=OFF -DSCHULER_BENCH=OFF -DSCHULER_UNITY=ON -DSCHULER_PCH=ON \
        -DSCHULER_WERROR=OFF -DSCHULER_PYTHON=ON -DSCHULER_ARCH=x86-64-v2 && \
    cmake --build /build && cd /build && SOURCE_DATE_EPOCH=$SOURCE_DATE_EPOCH cpack -G DEB

FROM debian:12
COPY --from=build /build/schuler_*.deb /tmp/
RUN apt-get update && apt-get install --yes --no-install-recommends /tmp/schuler_*.deb python3-numpy && \
    rm -rf /tmp/schuler_*.deb /var/lib/apt/lists/*
WORKDIR /data
ENTRYPOINT ["schuler"]
