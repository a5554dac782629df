//! Injects faults, for tests only: a test cannot choose when a real device is lost or runs out of
//! memory.
//!
//! The environment variable `SPLITSUM_TEST_FAULTS` holds words `SITE:COUNT:FAULT` separated by
//! commas. The COUNT-th call at the site, from 1, fails as the driver would let it; permanent
//! faults also fail all later calls.
//!
//! | site | call | faults |
//! |---|---|---|
//! | `submit` | `vkQueueSubmit2` | `device-lost` (permanent) |
//! | `allocate` | memory for a buffer or an image | `out-of-memory` (once), `memory-is-full` (permanent) |
//! | `surface` | the surface of a window | `not-present` (permanent): the display has no extension |
//! | `present` | `vkQueuePresentKHR` | `out-of-date`, `surface-lost` (once) |

use super::GpuError;
use ash::vk;
use std::sync::atomic::{AtomicU64, Ordering};

const VARIABLE: &str = "SPLITSUM_TEST_FAULTS";

/// A call that can be made to fail.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Site {
    Submit,
    Allocate,
    Surface,
    Present,
    /// Memory that the host reads; never fails.
    Read,
}

#[derive(Debug)]
struct Fault {
    site: Site,
    count: u64,
    /// Whether all later calls fail too.
    stays: bool,
    result: vk::Result,
}

/// The faults of one device, and how often each site was reached.
#[derive(Debug, Default)]
pub(super) struct Injector {
    faults: Vec<Fault>,
    calls: [AtomicU64; 5],
}

impl Injector {
    /// Reads the faults from the environment variable; none if it is not set.
    pub(super) fn from_environment() -> Result<Self, GpuError> {
        let text = std::env::var(VARIABLE).unwrap_or_default();
        let faults = text.split(',').filter(|word| !word.is_empty()).map(|word| {
            parse(word).ok_or_else(|| GpuError::UnknownTestFault {
                variable: VARIABLE,
                word: word.to_owned(),
            })
        });
        Ok(Self {
            faults: faults.collect::<Result<_, _>>()?,
            calls: Default::default(),
        })
    }

    /// Returns how often a site was reached.
    pub(super) fn count(&self, site: Site) -> u64 {
        self.calls[site as usize].load(Ordering::Relaxed)
    }

    /// Counts a call and fails it if a fault is due.
    pub(super) fn reach(&self, site: Site) -> Result<(), vk::Result> {
        let call = self.calls[site as usize].fetch_add(1, Ordering::Relaxed) + 1;
        let is_due = |fault: &&Fault| {
            fault.site == site && (call == fault.count || (fault.stays && call > fault.count))
        };
        self.faults
            .iter()
            .find(is_due)
            .map_or(Ok(()), |fault| Err(fault.result))
    }
}

fn parse(word: &str) -> Option<Fault> {
    let [site, count, fault] = word.split(':').collect::<Vec<_>>()[..] else {
        return None;
    };
    let (site, stays, result) = match (site, fault) {
        ("submit", "device-lost") => (Site::Submit, true, vk::Result::ERROR_DEVICE_LOST),
        ("allocate", "out-of-memory") => (
            Site::Allocate,
            false,
            vk::Result::ERROR_OUT_OF_DEVICE_MEMORY,
        ),
        ("allocate", "memory-is-full") => {
            (Site::Allocate, true, vk::Result::ERROR_OUT_OF_DEVICE_MEMORY)
        }
        ("surface", "not-present") => {
            (Site::Surface, true, vk::Result::ERROR_EXTENSION_NOT_PRESENT)
        }
        ("present", "out-of-date") => (Site::Present, false, vk::Result::ERROR_OUT_OF_DATE_KHR),
        ("present", "surface-lost") => (Site::Present, false, vk::Result::ERROR_SURFACE_LOST_KHR),
        _ => return None,
    };
    Some(Fault {
        site,
        count: count.parse().ok()?,
        stays,
        result,
    })
}
