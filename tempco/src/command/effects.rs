//! `tempco effects`

use crate::failure::{Answer, Failure};
use crate::terminal::say;
use clap::Args;
use firmware_core::effect::{ALL, About, about};
use std::fmt::Write;
use trainer::expression::{FUNCTIONS, NAMES};

/// Lists the physical effects that a model can contain, or explains one.
#[derive(Args)]
#[command(after_help = "Example:  tempco effects thermal-lag")]
pub struct Effects {
    /// Effect to explain
    name: Option<String>,
}

impl Effects {
    pub fn run(&self) -> Result<Answer, Failure> {
        match &self.name {
            None => {
                for about in ALL {
                    say!("{:20} {}", about.name, about.summary)?;
                }
            }
            Some(name) => {
                let about = about(name).ok_or_else(|| {
                    Failure::new(format_args!("there is no effect named `{name}`")).help("`tempco effects` lists them")
                })?;
                say!("{}", explain(about).trim_end())?;
            }
        }
        Ok(Answer::Yes)
    }
}

fn explain(about: &About) -> String {
    let mut text = format!("{} (number {})\n\n  {}\n\n", about.name, about.id, about.summary);
    let _ = writeln!(text, "  equation  {}\n  source    {}\n  needs     {}", about.equation, about.source, about.needs);
    if let Some(channel) = about.channel {
        let _ = writeln!(text, "  channel   {channel}");
    }
    for parameter in about.parameters {
        let _ = writeln!(
            text,
            "  parameter {} [{}], {} … {}",
            parameter.name, parameter.unit, parameter.low, parameter.high
        );
    }
    if about.takes_program() {
        let _ = writeln!(text, "\n  An expression joins these with + - * / ^2 and parentheses:");
        for (name, meaning, _) in NAMES {
            let _ = writeln!(text, "    {name:22}  {meaning}");
        }
        let functions: Vec<String> = FUNCTIONS.iter().map(|(name, _)| format!("{name}(…)")).collect();
        let _ = writeln!(text, "    {:22}  every other column of the campaign, such as supply_v", "a channel");
        let _ = writeln!(text, "    {:22}  of any of these; and numbers", functions.join(" "));
        let _ = writeln!(text, "\n  tempco add model.toml --expression \"{EXAMPLE}\" campaign.csv -o better.toml");
    }
    text
}

const EXAMPLE: &str = "supply_v * temperature_rate";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_effect_is_explained_with_its_channel_its_parameters_and_what_an_expression_may_name() {
        let explained = |name: &str| explain(about(name).expect("an effect"));
        for about in ALL {
            let text = explain(about);
            assert!(
                text.starts_with(&format!("{} (number {})\n\n  {}\n", about.name, about.id, about.summary)),
                "{text}"
            );
            assert_eq!(text.matches("\n  parameter ").count(), about.parameters.len(), "{text}");
            assert_eq!(text.contains("An expression joins"), about.takes_program(), "{text}");
        }
        assert!(explained("supply-voltage").contains("\n  channel   supply_v\n"));
        assert!(!explained("thermal-lag").contains("channel"));
        let own = ALL.iter().copied().find(|about| about.takes_program()).map(explain).expect("an effect of one's own");
        assert!(NAMES.iter().all(|(name, meaning, _)| own.contains(name) && own.contains(meaning)), "{own}");
    }
}
