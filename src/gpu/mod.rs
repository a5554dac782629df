//! The only unsafe code: Vulkan.
