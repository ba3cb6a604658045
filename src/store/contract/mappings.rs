//! Stored mappings.

use super::*;

pub(super) async fn a_mapping_is_found_by_its_name_and_by_the_latest_of_its_layout(
    store: &dyn Store,
) {
    let row = |name: &str, layout: Option<&str>| MappingRow {
        name: name.into(),
        settings: format!("{{\"machine\":\"{name}\"}}"),
        layout: layout.map(str::to_owned),
        updated_at_ms: 0,
    };
    let put = async |name: &str, layout: Option<&str>| {
        store.put_mapping(&all(), &row(name, layout), 10).await.unwrap()
    };
    assert_eq!(put("b", Some("one")).await, Some(true));
    assert_eq!(put("a", Some("two")).await, Some(true));
    assert_eq!(put("c", None).await, Some(true));
    assert_eq!(put("b", Some("two")).await, Some(false), "it is there already");
    let names = async || {
        let rows = store.mappings(&all(), 10).await.unwrap();
        rows.into_iter().map(|row| row.name).collect::<Vec<_>>()
    };
    assert_eq!(names().await, ["a", "b", "c"]);
    assert_eq!(store.mappings(&all(), 2).await.unwrap().len(), 2);
    let b = store.mapping(&all(), "b").await.unwrap().unwrap();
    assert!(b.updated_at_ms > 0);
    assert_eq!(b, MappingRow { updated_at_ms: b.updated_at_ms, ..row("b", Some("two")) });
    assert_eq!(store.mapping_of_layout(&all(), "one").await.unwrap(), None);
    // Times are kept in milliseconds.
    tokio::time::sleep(Duration::from_millis(2)).await;
    put("b", Some("two")).await;
    assert_eq!(store.mapping_of_layout(&all(), "two").await.unwrap().unwrap().name, "b");
    assert!(store.delete_mapping(&all(), "b").await.unwrap());
    assert!(!store.delete_mapping(&all(), "b").await.unwrap());
    assert_eq!(store.mapping_of_layout(&all(), "two").await.unwrap().unwrap().name, "a");
    assert_eq!(store.mapping(&all(), "b").await.unwrap(), None);
    assert_eq!(names().await, ["a", "c"]);
}

pub(super) async fn an_owner_has_so_many_mappings_and_may_still_replace_them(store: &dyn Store) {
    let of = |owner: &str| Reach { owner: owner.into(), reads_all: false, changes_all: false };
    let put = async |owner: &str, name: &str| {
        let (name, settings) = (name.to_owned(), "{}".to_owned());
        let row = MappingRow { name, settings, layout: None, updated_at_ms: 0 };
        store.put_mapping(&of(owner), &row, 2).await.unwrap()
    };
    assert_eq!((put("a", "one").await, put("a", "two").await), (Some(true), Some(true)));
    assert_eq!((put("a", "three").await, put("a", "two").await), (None, Some(false)));
    assert_eq!(put("b", "three").await, Some(true), "each owner has as many");
    assert_eq!(store.mappings(&of("a"), 10).await.unwrap().len(), 2);
    assert!(store.delete_mapping(&of("a"), "one").await.unwrap());
    assert_eq!(put("a", "three").await, Some(true));
}
