//! From the one list of settings to all that has to name each of them.

/// Declares the settings of a server, one entry each:
///
/// ```text
/// /// Help, also the text of the flag.
/// #[arg(…)]                         flag and environment variable, as `clap` takes them
/// name: Type = |given| default, in low..=high;
/// ```
///
/// The default sees what was given for the other settings. Without a default a
/// setting may stay unset; without a range every value of its type will do.
///
/// Made of them are
///
/// * `Settings`, what one source says, each setting an `Option`: read from flags, the
///   environment and TOML, laid over another source, listed;
/// * `ServeConfig`, the values in effect, an `Option` only where there is no default.
macro_rules! settings {
    ($(
        $(#[doc = $help:literal])+
        #[arg($($flag:tt)+)]
        $name:ident: $type:ty $(= $default:expr)? $(, in $range:expr)?;
    )+) => {
        /// What one source says; `None` where it says nothing.
        ///
        /// The same list is the flags and environment variables of `serve` and
        /// `config show`, and the keys of the file.
        #[derive(Debug, Clone, Default, PartialEq, serde::Deserialize, clap::Args)]
        #[serde(deny_unknown_fields)]
        #[group(skip)]
        pub struct Settings {$(
            $(#[doc = $help])+
            #[arg($($flag)+)]
            pub $name: Option<$type>,
        )+}

        /// What a server needs to know, checked.
        #[derive(Debug, Clone, PartialEq, Eq)]
        pub struct ServeConfig {$(
            $(#[doc = $help])+
            pub $name: settings!(@type $type $(, $default)?),
        )+}

        impl Settings {
            /// These settings, and of `below` what they do not say.
            pub fn over(self, below: Self) -> Self {
                Self { $($name: self.$name.or(below.$name),)+ }
            }

            /// These settings, and the defaults of what they do not say; what is still
            /// `None` has no limit.
            pub fn completed(self) -> Self {
                let below = Self { $($name: settings!(@default &self $(, $default)?),)+ };
                self.over(below)
            }

            /// Names and values, the latter as TOML; `None` where nothing is said.
            pub fn entries(&self) -> Vec<(&'static str, Option<String>)> {
                fn text<T: serde::Serialize>(value: Option<&T>) -> Option<String> {
                    Some(toml::Value::try_from(value?).ok()?.to_string())
                }
                vec![$((stringify!($name), text(self.$name.as_ref())),)+]
            }

            /// The values in effect of settings that are completed, each within its range.
            ///
            /// # Errors
            /// [`ConfigError::Range`](super::ConfigError::Range) of the first that is not.
            pub(super) fn in_range(self) -> Result<ServeConfig, super::ConfigError> {
                $($(super::within(stringify!($name), self.$name, $range)?;)?)+
                let given = self.clone();
                Ok(ServeConfig { $($name: settings!(@value self.$name, &given $(, $default)?),)+ })
            }
        }
    };
    (@type $type:ty) => { Option<$type> };
    (@type $type:ty, $default:expr) => { $type };
    (@default $given:expr) => { None };
    (@default $given:expr, $default:expr) => { Some(settings!(@call $given, $default)) };
    (@value $value:expr, $given:expr) => { $value };
    (@value $value:expr, $given:expr, $default:expr) => {
        $value.unwrap_or_else(|| settings!(@call $given, $default))
    };
    // A closure has to be told the type of what it is given.
    (@call $given:expr, $default:expr) => {{
        fn call<T>(given: &Settings, default: impl FnOnce(&Settings) -> T) -> T {
            default(given)
        }
        call($given, $default)
    }};
}

pub(super) use settings;
