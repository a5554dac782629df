//! What the driver and the system tell of clocks and load: read robustly, and "unknown" where nobody tells.

use splitsum::run::host::{GpuState, HostState, UNKNOWN, cpu_mhz, load_average, parse_nvidia};

#[test]
fn the_line_of_the_named_gpu_is_read_and_missing_values_stay_missing() {
    let text =
        "NVIDIA H100 80GB HBM3, 1980, 0x0000000000000000\nTesla T4, [N/A], 0x0000000000000024\nA, 1, [Not Supported]\n";
    let h100 = parse_nvidia(text, "NVIDIA H100 80GB HBM3").unwrap();
    assert_eq!((h100.sm_mhz, h100.throttle), (Some(1980.0), Some(Vec::new())));
    let t4 = parse_nvidia(text, "Tesla T4").unwrap();
    assert_eq!(
        (t4.sm_mhz, t4.throttle.unwrap()),
        (None, vec!["sw-power-cap".to_owned(), "sw-thermal-slowdown".to_owned()])
    );
    assert_eq!(parse_nvidia(text, "A").unwrap().throttle, None);
    // Two GPUs of one name: which of them is meant cannot be told.
    for text in ["", "No devices were found", "A, 1", "A, 1, 2, 0x0", "B, 1, 0x0", "A, 1, 0x0\nA, 9, 0x0"] {
        assert_eq!(parse_nvidia(text, "A"), None, "{text:?}");
    }
    assert_eq!(load_average("0.52 0.58 0.59 1/389 12345"), Some(vec![0.52, 0.58, 0.59]));
    assert_eq!(load_average("0.52 x"), None);
}

#[test]
fn only_disturbances_count_as_slowdown() {
    let state = |reasons: Option<&[&str]>| HostState {
        gpu: Some(GpuState {
            sm_mhz: Some(1000.0),
            throttle: reasons.map(|words| words.iter().map(|word| word.to_string()).collect()),
            ..GpuState::default()
        }),
        cpu_mhz: Some(3000.0),
        load_average: None,
    };
    assert_eq!(state(Some(&["gpu-idle", "applications-clocks-setting"])).slowdown(), "");
    assert_eq!(state(Some(&["gpu-idle", "hw-slowdown", "sw-power-cap"])).slowdown(), "hw-slowdown sw-power-cap");
    assert_eq!(state(None).slowdown(), UNKNOWN);
    assert_eq!(HostState::default().slowdown(), UNKNOWN);
    assert_eq!(state(None).clock_mhz("discrete-gpu"), Some(1000.0));
    assert_eq!(state(None).clock_mhz("cpu"), Some(3000.0));
    assert_eq!(HostState::default().clock_mhz("discrete-gpu"), None);
}

#[test]
fn clocks_of_processors_are_averaged_where_the_system_has_them() {
    let dir = tempfile::tempdir().unwrap();
    assert_eq!(cpu_mhz(dir.path()), None);
    for (cpu, khz) in [("cpu0", "2400000\n"), ("cpu1", "3600000\n"), ("cpufreq", "ignored")] {
        let folder = dir.path().join(cpu).join("cpufreq");
        std::fs::create_dir_all(&folder).unwrap();
        std::fs::write(folder.join("scaling_cur_freq"), khz).unwrap();
    }
    assert_eq!(cpu_mhz(dir.path()), Some(3000.0));
}
