//! judge 0.12|0.13 UNITS, judge 38 OPTION...: AUTD3 units as their makers emulate them, which say what they sound.
//! The releases of the UDP line have the same functions, so that one source file is compiled for each.
mod v38;
mod v0_12 {
    use emulator_0_12 as emulator;
    use wire_0_12 as wire;
    include!("udp.rs");
}
mod v0_13 {
    use emulator_0_13 as emulator;
    use wire_0_13 as wire;
    include!("udp.rs");
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let units = || words.get(1).map_or(Ok(1), |text| text.parse());
    match words.first().map_or("", String::as_str) {
        "0.12" => v0_12::run(units()?),
        "0.13" => v0_13::run(units()?),
        "38" => Ok(v38::run()),
        other => Err(format!("there is no release '{other}'").into()),
    }
}
