# syntax=docker/dockerfile:1

FROM rust:1.95-slim-bookworm AS build
RUN apt-get update && apt-get install --yes --no-install-recommends gcc libc6-dev \
    && rm -rf /var/lib/apt/lists/*
WORKDIR /source
COPY Cargo.toml Cargo.lock ./
COPY src ./src
COPY crates ./crates
COPY migrations ./migrations
# The manifest names the integration tests and the benches; nothing here builds them.
RUN mkdir -p tests/integration benches/load benches/queue \
    && touch tests/integration/main.rs benches/load/main.rs benches/queue/main.rs \
    && cargo build --release --locked --bin servoscope

FROM debian:bookworm-slim
# Whom webhooks and MQTT trust.
RUN apt-get update && apt-get install --yes --no-install-recommends ca-certificates \
    && rm -rf /var/lib/apt/lists/*
RUN useradd --system --uid 10001 --home-dir /nonexistent servoscope \
    && install --directory --owner servoscope --group servoscope /data
COPY --from=build /source/target/release/servoscope /usr/local/bin/servoscope
USER servoscope
VOLUME /data
EXPOSE 8080
# The image has no HTTP client; bash opens the connection itself.
HEALTHCHECK --interval=10s --timeout=3s --start-period=5s CMD ["bash", "-c", \
    "exec 3<>/dev/tcp/127.0.0.1/8080 && printf 'GET /readyz HTTP/1.0\\r\\n\\r\\n' >&3 && grep -q ' 200 ' <&3"]
# Inside a container every address is its own: it does not start without a key. The first one
# comes with SERVOSCOPE_ADMIN_KEY or SERVOSCOPE_ADMIN_KEY_FILE.
ENTRYPOINT ["servoscope"]
CMD ["serve", "--listen", "0.0.0.0:8080", "--data-dir", "/data"]
