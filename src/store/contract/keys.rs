//! Keys and sessions.

use super::*;

pub(super) fn key_row(id: &str, expires_at_ms: Option<i64>) -> KeyRow {
    KeyRow {
        id: id.into(),
        name: "rig 7".into(),
        scopes: "[\"read\"]".into(),
        sha256: format!("digest of {id}"),
        created_at_ms: 0,
        expires_at_ms,
        revoked_at_ms: None,
        used_at_ms: None,
        quotas: "{}".into(),
        now_ms: 0,
    }
}

pub(super) async fn a_key_is_valid_until_it_expires_or_is_revoked(store: &dyn Store) {
    assert!(!store.has_keys().await.unwrap());
    assert_eq!(store.key("a").await.unwrap(), None);
    assert!(store.insert_key(&key_row("a", None)).await.unwrap());
    let other = KeyRow { sha256: "another".into(), ..key_row("a", None) };
    assert!(!store.insert_key(&other).await.unwrap(), "the first one stays");
    let a = store.key("a").await.unwrap().unwrap();
    assert_eq!((a.sha256.as_str(), a.used_at_ms, a.is_valid()), ("digest of a", None, true));
    assert!(a.created_at_ms > 0 && a.now_ms >= a.created_at_ms);
    assert!(store.has_keys().await.unwrap() && store.has_valid_key().await.unwrap());

    store.key_used("a").await.unwrap();
    assert!(store.key("a").await.unwrap().unwrap().used_at_ms.is_some());
    assert!(store.replace_key("a", "new", Some(a.now_ms + 60_000)).await.unwrap());
    let replaced = store.key("a").await.unwrap().unwrap();
    assert_eq!((replaced.sha256.as_str(), replaced.is_valid()), ("new", true));

    assert!(store.revoke_key("a").await.unwrap() && !store.revoke_key("b").await.unwrap());
    let revoked = store.key("a").await.unwrap().unwrap();
    assert!(revoked.revoked_at_ms.is_some() && !revoked.is_valid());
    assert!(!store.replace_key("a", "newer", None).await.unwrap(), "it was revoked");
    assert!(store.insert_key(&key_row("b", Some(a.now_ms))).await.unwrap());
    assert!(!store.key("b").await.unwrap().unwrap().is_valid(), "it has expired");
    assert!(store.has_keys().await.unwrap() && !store.has_valid_key().await.unwrap());
    assert_eq!(store.keys(10).await.unwrap().len(), 2);
    assert_eq!(store.keys(1).await.unwrap().len(), 1);
}

pub(super) async fn a_key_has_quotas_of_its_own_from_its_start_or_later(store: &dyn Store) {
    let row = KeyRow { quotas: "{\"jobs\":1}".into(), ..key_row("a", None) };
    store.insert_key(&row).await.unwrap();
    store.insert_key(&key_row("b", None)).await.unwrap();
    let quotas = async |id: &str| store.key(id).await.unwrap().unwrap().quotas;
    assert_eq!((quotas("a").await, quotas("b").await), ("{\"jobs\":1}".into(), "{}".into()));
    assert!(store.limit_key("a", "{\"mib\":2}").await.unwrap());
    assert!(!store.limit_key("c", "{}").await.unwrap(), "there is none");
    assert_eq!((quotas("a").await, quotas("b").await), ("{\"mib\":2}".into(), "{}".into()));
    let end = store.key("a").await.unwrap().unwrap().now_ms + 600_000;
    store.insert_session("one", "a", end).await.unwrap();
    assert_eq!(store.session("one").await.unwrap().unwrap().quotas, "{\"mib\":2}");
    assert!(store.keys(10).await.unwrap().iter().any(|key| key.quotas == "{\"mib\":2}"));
    store.replace_key("a", "new", None).await.unwrap();
    assert_eq!(quotas("a").await, "{\"mib\":2}", "another secret changes nothing of it");
}

pub(super) async fn a_session_is_of_its_key_until_either_ends(store: &dyn Store) {
    store.insert_key(&key_row("a", None)).await.unwrap();
    let now = store.key("a").await.unwrap().unwrap().now_ms;
    store.insert_session("one", "a", now + 600_000).await.unwrap();
    store.insert_session("two", "a", now + 600_000).await.unwrap();
    store.insert_session("ended", "a", now).await.unwrap();
    store.insert_session("of nobody", "b", now + 600_000).await.unwrap_err();
    assert_eq!(store.session("one").await.unwrap().unwrap().id, "a");
    assert_eq!(store.session("ended").await.unwrap(), None);
    assert_eq!(store.session("nothing").await.unwrap(), None);
    store.delete_session("one").await.unwrap();
    assert_eq!(store.session("one").await.unwrap(), None);
    assert!(store.session("two").await.unwrap().is_some());
    store.replace_key("a", "new", None).await.unwrap();
    assert_eq!(store.session("two").await.unwrap(), None, "the key has another secret");
    store.insert_session("three", "a", now + 600_000).await.unwrap();
    store.revoke_key("a").await.unwrap();
    assert_eq!(store.session("three").await.unwrap(), None);
}

pub(super) async fn of_more_sessions_than_a_key_may_have_the_oldest_end(store: &dyn Store) {
    store.insert_key(&key_row("a", None)).await.unwrap();
    store.insert_key(&key_row("b", None)).await.unwrap();
    let end = store.key("a").await.unwrap().unwrap().now_ms + 600_000;
    // Of another key, and older than all.
    store.insert_session("other", "b", end - 1).await.unwrap();
    for (session, later) in [("one", 0), ("three", 2), ("two", 1)] {
        store.insert_session(session, "a", end + later).await.unwrap();
    }
    let left = async || {
        let mut left = Vec::new();
        for session in ["one", "two", "three", "other"] {
            if store.session(session).await.unwrap().is_some() {
                left.push(session);
            }
        }
        left
    };
    store.end_oldest_sessions("a", 3).await.unwrap();
    assert_eq!(left().await, ["one", "two", "three", "other"]);
    store.end_oldest_sessions("a", 1).await.unwrap();
    assert_eq!(left().await, ["three", "other"]);
}
