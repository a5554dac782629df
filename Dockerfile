# The demo in a container, without a GPU: Mesa's lavapipe renders. The steps are the ones of scripts/bare.sh.
#
#     docker build --tag splitsum .
#     docker run --rm --volume "$PWD/runs:/splitsum/runs" splitsum                # writes runs/quick/report.html
#     docker run --rm splitsum target/release/splitsum --help
FROM debian:12-slim
RUN apt-get update -q \
    && apt-get install -y -q --no-install-recommends ca-certificates curl \
    && rm -rf /var/lib/apt/lists/*
RUN curl --proto '=https' --tlsv1.2 -sSf https://sh.rustup.rs | sh -s -- -y --profile minimal --default-toolchain stable
ENV PATH=/root/.cargo/bin:$PATH
WORKDIR /splitsum
COPY . .
# Installs the compiler and the driver, builds, and checks that a device answers.
RUN sh -c '. scripts/setup.sh && require compiler loader driver' \
    && cargo build --release --locked \
    && target/release/splitsum devices
CMD ["sh", "scripts/demo.sh"]
