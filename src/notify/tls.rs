//! Whom a connection trusts: the certificates that the system trusts.

use std::sync::{Arc, LazyLock};

use rustls::{ClientConfig, RootCertStore};
use tracing::warn;

/// Read once: it takes a while, and a new certificate is worth a restart.
static CONFIG: LazyLock<ClientConfig> = LazyLock::new(load);

/// How to speak TLS.
pub fn config() -> ClientConfig {
    CONFIG.clone()
}

fn load() -> ClientConfig {
    let found = rustls_native_certs::load_native_certs();
    let mut roots = RootCertStore::empty();
    roots.add_parsable_certificates(found.certs);
    if roots.is_empty() {
        warn!("the system trusts no certificate: no connection by TLS will be made");
    }
    let provider = Arc::new(rustls::crypto::ring::default_provider());
    ClientConfig::builder_with_provider(provider)
        .with_safe_default_protocol_versions()
        .expect("the provider has the suites of both versions")
        .with_root_certificates(roots)
        .with_no_client_auth()
}
