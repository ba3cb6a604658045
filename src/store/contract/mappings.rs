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
    assert!(store.put_mapping(&all(), &row("b", Some("one"))).await.unwrap());
    assert!(store.put_mapping(&all(), &row("a", Some("two"))).await.unwrap());
    assert!(store.put_mapping(&all(), &row("c", None)).await.unwrap());
    assert!(
        !store.put_mapping(&all(), &row("b", Some("two"))).await.unwrap(),
        "it is there already"
    );
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
    store.put_mapping(&all(), &row("b", Some("two"))).await.unwrap();
    assert_eq!(store.mapping_of_layout(&all(), "two").await.unwrap().unwrap().name, "b");
    assert!(store.delete_mapping(&all(), "b").await.unwrap());
    assert!(!store.delete_mapping(&all(), "b").await.unwrap());
    assert_eq!(store.mapping_of_layout(&all(), "two").await.unwrap().unwrap().name, "a");
    assert_eq!(store.mapping(&all(), "b").await.unwrap(), None);
    assert_eq!(names().await, ["a", "c"]);
}
