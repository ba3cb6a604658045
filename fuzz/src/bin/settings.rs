//! Settings of a server in TOML: taken, or refused with a reason. What is in effect can be written
//! as a file and read again.
#![no_main]

use libfuzzer_sys::fuzz_target;
use servoscope::config::{ServeConfig, Settings};

fuzz_target!(|text: &[u8]| {
    let Ok(text) = std::str::from_utf8(text) else { return };
    let settings: Settings = match toml::from_str(text) {
        Ok(settings) => settings,
        Err(error) => {
            assert!(!error.to_string().is_empty());
            return;
        }
    };
    let in_effect = settings.clone().completed();
    let lines = in_effect.entries().into_iter().filter_map(|(name, value)| Some((name, value?)));
    let written: String = lines.map(|(name, value)| format!("{name} = {value}\n")).collect();
    toml::from_str::<Settings>(&written).expect("it is a file of settings");
    // The file of a key is not read: a name may lead anywhere.
    if let Err(error) = ServeConfig::check(settings) {
        assert!(!error.to_string().is_empty());
    }
});
