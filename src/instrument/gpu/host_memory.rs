//! Returns large blocks of memory to the system.
//!
//! Images of a software driver are memory of the host. glibc maps a block above a threshold by
//! itself and unmaps it when it is freed, but each freed block raises the threshold to its own size,
//! up to 32 MB. Later images then lie in heaps, between small blocks that keep them from being
//! returned: a run of `quick` keeps 50 MB so, a process that opens many devices gigabytes.

/// Blocks from this size on are mapped by themselves, bytes. An image of 256x256 pixels has as many.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
const THRESHOLD: libc::c_int = 1 << 20;

/// Fixes the threshold of glibc; does nothing elsewhere.
pub(super) fn return_large_blocks() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    {
        use std::sync::Once;
        static FIRST_DEVICE: Once = Once::new();
        FIRST_DEVICE.call_once(|| {
            // SAFETY: the call takes two numbers and locks the allocator. A refusal costs only
            // memory.
            unsafe { libc::mallopt(libc::M_MMAP_THRESHOLD, THRESHOLD) };
        });
    }
}
