//! Statements of noise in JSON.

use super::*;

#[test]
fn json_states_noise_as_csv_does() {
    let csv = ok(&format!(
        "magnitude,omega_rad_s,re,im,coherence,averages,gain_std,gain_db_std,phase_std_deg\n\
        2,1,3,-4,0.8,2,,,\n2,2,3,-4,,,{GAIN_STD},,{PHASE_STD_DEG}\n2,3,3,-4,,,,{GAIN_DB_STD},\n"
    ));
    let point = |omega: u8, noise: &str| {
        format!(r#"{{"magnitude":2,"omega_rad_s":{omega},"re":3,"im":-4,{noise}}}"#)
    };
    let gain = format!(r#""gain_std":{GAIN_STD},"phase_std_deg":{PHASE_STD_DEG}"#);
    let decibel = format!(r#""gain_db_std":{GAIN_DB_STD}"#);
    let own = [point(1, r#""coherence":0.8,"averages":2"#), point(2, &gain), point(3, &decibel)];
    let shared = [point(1, r#""coherence":0.8"#), point(2, &gain), point(3, &decibel)];
    let experiment = |omega: u8, beside: &str, noise: &str| {
        format!(
            r#"{{"magnitude":2,"omega_rad_s":{omega},{beside}
                "harmonics":[{{"re":3,"im":-4,{noise}}}]}}"#
        )
    };
    let experiments = [
        experiment(1, r#""averages":2,"#, r#""coherence":0.8"#),
        experiment(2, "", &gain),
        experiment(3, "", &decibel),
    ];
    for text in [
        format!("[{}]", own.join(",")),
        format!(r#"{{"averages":2,"rows":[{}]}}"#, shared.join(",")),
        format!(r#"{{"metadata":{{"averages":"2"}},"rows":[{}]}}"#, shared.join(",")),
        format!(
            r#"{{"columns":{{"magnitude":[2,2,2],"omega_rad_s":[1,2,3],"re":[3,3,3],
                "im":[-4,-4,-4],"coherence":[0.8,null,null],"averages":[2,null,null],
                "gain_std":[null,{GAIN_STD},null],"gain_db_std":[null,null,{GAIN_DB_STD}],
                "phase_std_deg":[null,{PHASE_STD_DEG},null]}}}}"#
        ),
        format!(r#"{{"experiments":[{}]}}"#, experiments.join(",")),
    ] {
        let json = ok(&text);
        assert_eq!(json.experiments(), csv.experiments(), "{text}");
        assert_eq!(json.notes(), csv.notes(), "{text}");
    }
}

#[test]
fn what_json_states_wrongly_is_named_by_its_path() {
    let row =
        |noise: &str| format!(r#"[{{"magnitude":2,"omega_rad_s":1,"re":3,"im":-4,{noise}}}]"#);
    refused(&row(r#""coherence":0.9"#), None, "[0].averages", "add the column");
    refused(&row(r#""coherence":2,"averages":2"#), None, "[0].coherence", "above 1");
    refused(&row(r#""coherence":1,"std":2"#), None, "[0].coherence", "std and coherence");
    refused(&row(r#""gain_db_std":"x""#), None, "[0].gain_db_std", "a string");
    let metadata = format!(r#"{{"averages":-1,"rows":{}}}"#, row(r#""coherence":0.9"#));
    refused(&metadata, None, "averages", "positive");
}
