//! `splitsum devices`.

use super::{Failure, print};
use splitsum::draw::markdown::{Align, MarkdownTable};
use splitsum::instrument::pipeline::devices;

pub fn execute() -> Result<(), Failure> {
    let mut table = MarkdownTable::new(&[
        ("--device", Align::Right),
        ("name", Align::Left),
        ("type", Align::Left),
        ("driver", Align::Left),
        ("Vulkan", Align::Left),
        ("memory, MiB", Align::Right),
    ]);
    for (index, device) in devices().map_err(Failure::input)?.iter().enumerate() {
        table.row(&[
            index.to_string(),
            device.name.clone(),
            device.device_type.to_owned(),
            device.driver.clone(),
            device.api_version.clone(),
            (device.memory_bytes >> 20).to_string(),
        ]);
    }
    print(&table.to_string())
}
