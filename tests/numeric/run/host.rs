//! Load and clocks of the machine.

use splitsum::run::host::{cpu_mhz, load_average};

#[test]
fn the_load_is_three_numbers() {
    assert_eq!(load_average("0.52 0.58 0.59 1/389 12345"), Some(vec![0.52, 0.58, 0.59]));
    assert_eq!(load_average("0.52 x"), None);
}

#[test]
fn clocks_of_processors_are_averaged_if_the_system_reports_them() {
    let dir = tempfile::tempdir().unwrap();
    assert_eq!(cpu_mhz(dir.path()), None);
    for (cpu, khz) in [("cpu0", "2400000\n"), ("cpu1", "3600000\n"), ("cpufreq", "ignored")] {
        let folder = dir.path().join(cpu).join("cpufreq");
        std::fs::create_dir_all(&folder).unwrap();
        std::fs::write(folder.join("scaling_cur_freq"), khz).unwrap();
    }
    assert_eq!(cpu_mhz(dir.path()), Some(3000.0));
}
