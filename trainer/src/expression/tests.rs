use super::*;
use firmware_core::program::Input;

fn channels() -> Vec<String> {
    ["supply_v", "pressure_pa"].map(str::to_owned).to_vec()
}

/// The value for level 3 g, temperature 20 °C, supply 5 V, pressure 8 Pa and age 0.
fn value(text: &str) -> Option<f64> {
    let read = |input| match input {
        Input::Temperature => 20.0,
        Input::Level => 3.0,
        Input::Channel(0) => 5.0,
        Input::Channel(1) => 8.0,
        _ => 0.0,
    };
    let expression = Expression::parse(text, &channels()).unwrap_or_else(|error| panic!("{error}"));
    expression.program.evaluate(read)
}

#[test]
fn an_expression_means_what_arithmetic_says() {
    for (text, expected) in [
        ("supply_v", Some(5.0)),
        ("  supply_v*level_g ", Some(15.0)),
        ("level_g + supply_v * pressure_pa", Some(43.0)),
        ("(level_g + supply_v) * pressure_pa", Some(64.0)),
        ("pressure_pa - supply_v - level_g", Some(0.0)),
        ("pressure_pa / 4 / 2 * level_g", Some(3.0)),
        ("-level_g^2", Some(-9.0)),
        ("(-level_g)^2", Some(9.0)),
        ("2 - -level_g", Some(5.0)),
        ("-2 * level_g", Some(-6.0)),
        ("--level_g", Some(3.0)),
        ("1.5e1 + level_g - .5", Some(17.5)),
        ("2E-1*supply_v", Some(1.0 + 1.490_116_119_384_765_6e-8)),
        ("abs(level_g - supply_v)", Some(2.0)),
        ("sqrt(pressure_pa * 2)^2 / 4", Some(4.0)),
        ("exp(temperature_rate + age_days)", Some(1.0)),
        ("supply_v / power_on_s", None),
        ("temperature_c - 20 * (delta_f_hz - -1)", Some(0.0)),
    ] {
        assert_eq!(value(text), expected, "{text}");
    }
}

#[test]
fn an_error_gives_the_column_what_was_found_and_what_was_expected() {
    let table = [
        ("", 1, "the end", "a name, a number or `(`", None),
        ("supply_v *", 11, "the end", "a name, a number or `(`", None),
        ("supply_v supply_v", 10, "`supply_v`", "an operator", None),
        ("supply_v * temprature_rate", 12, "`temprature_rate`", "temperature_rate", Some("temperature_rate")),
        ("suply_v", 1, "`suply_v`", "supply_v, pressure_pa, abs", Some("supply_v")),
        ("sqr(supply_v)", 1, "`sqr`", "sqrt", Some("sqrt")),
        ("quark", 1, "`quark`", "one of temperature_c", None),
        ("(supply_v + 1", 14, "the end", "`)`", None),
        ("supply_v)", 9, "`)`", "the end", None),
        ("sqrt supply_v", 6, "`supply_v`", "`(`", None),
        ("supply_v ^ 3", 12, "`3`", "2: other powers", None),
        ("supply_v ^", 11, "the end", "2: other powers", None),
        ("supply_v + * 3", 12, "`*`", "a name, a number or `(`", None),
        ("supply_v # 3", 10, "`#`", "an operator", None),
        ("1e99 * supply_v", 1, "`1e99`", "a number below 3.4e38", None),
        ("1.2.3 * supply_v", 1, "`1.2.3`", "a number", None),
        ("2 * 3", 1, "numbers alone", "something that is measured", None),
        ("°C", 1, "`°`", "a name", None),
    ];
    for (text, column, found, expected, nearest) in table {
        let error = Expression::parse(text, &channels()).expect_err(text);
        assert_eq!((error.column, error.found.as_str()), (column, found), "{text}: {error}");
        assert!(error.expected.contains(expected), "{text}: {error}");
        assert_eq!(error.nearest.as_deref(), nearest, "{text}: {error}");
    }
}

#[test]
fn what_a_device_has_no_room_for_is_refused_where_the_room_ends() {
    let text = "supply_v".to_owned() + &" + 1.5 * level_g".repeat(4);
    let error = Expression::parse(&text, &channels()).expect_err("33 bytes");
    assert!(error.found.contains("32 bytes") && error.column == 58, "{error}");
    let text = "(".repeat(100_000) + "supply_v";
    assert!(Expression::parse(&text, &channels()).is_err());
}

#[test]
fn a_program_printed_and_parsed_again_is_the_same_program() {
    for text in [
        "supply_v * temperature_rate",
        "(supply_v - 5) * temperature_rate^2 / 3",
        "supply_v - (level_g - temperature_c) - 1",
        "supply_v / (level_g * temperature_c) * -0.125",
        "-(supply_v + 1)^2 + (-level_g)^2 - -age_days",
        "(temperature_departure^2)^2 * abs(level_g - 1e-20)",
        "exp(-power_on_s / 600) * sqrt(pressure_pa)",
        "(-2)^2 * supply_v",
    ] {
        let code = |text: &str| Expression::parse(text, &channels()).unwrap_or_else(|error| panic!("{error}")).code;
        let printed = print(&code(text), &channels()).expect("it is a program");
        assert_eq!(code(&printed), code(text), "{text} printed as {printed}");
    }
    let print = |code: &[u8]| print(code, &channels());
    assert_eq!(print(&[0x80, 0x03, 0x12]).as_deref(), Some("supply_v * temperature_rate"));
    assert_eq!((print(&[0x10]), print(&[0x82]), print(&[])), (None, None, None));
}

#[test]
fn an_expression_says_what_it_reads() {
    let reads = |text: &str| Expression::parse(text, &channels()).expect("it is right").reads();
    assert!(reads("supply_v * temperature_rate").past && !reads("supply_v * temperature_c").past);
    let expression = Expression::parse("pressure_pa * level_g", &channels()).expect("it is right");
    assert_eq!([0, 1, 2, 8, 999].map(|channel| expression.follows(channel)), [false, true, false, false, false]);
    assert!(alike("a * b", " a*b ") && !alike("a * b", "b * a"));
}
