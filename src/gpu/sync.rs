//! Tracked access of a buffer or a mip level, and the barrier that the next access needs.

use ash::vk;

/// What a command does with a resource: where and how, and in which layout an image must be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Access {
    pub(super) stage: vk::PipelineStageFlags2,
    pub(super) access: vk::AccessFlags2,
    pub(super) layout: vk::ImageLayout,
    pub(super) writes: bool,
}

impl Access {
    const fn new(
        stage: vk::PipelineStageFlags2,
        access: vk::AccessFlags2,
        layout: vk::ImageLayout,
        writes: bool,
    ) -> Self {
        Self { stage, access, layout, writes }
    }

    const SHADERS: vk::PipelineStageFlags2 = vk::PipelineStageFlags2::from_raw(
        vk::PipelineStageFlags2::COMPUTE_SHADER.as_raw()
            | vk::PipelineStageFlags2::VERTEX_SHADER.as_raw()
            | vk::PipelineStageFlags2::FRAGMENT_SHADER.as_raw(),
    );

    pub(super) const SAMPLE: Self = Self::new(
        Self::SHADERS,
        vk::AccessFlags2::SHADER_SAMPLED_READ,
        vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL,
        false,
    );
    pub(super) const IMAGE_WRITE: Self = Self::new(
        vk::PipelineStageFlags2::COMPUTE_SHADER,
        vk::AccessFlags2::SHADER_STORAGE_WRITE,
        vk::ImageLayout::GENERAL,
        true,
    );
    pub(super) const IMAGE_READ_WRITE: Self = Self::new(
        vk::PipelineStageFlags2::COMPUTE_SHADER,
        vk::AccessFlags2::from_raw(
            vk::AccessFlags2::SHADER_STORAGE_READ.as_raw() | vk::AccessFlags2::SHADER_STORAGE_WRITE.as_raw(),
        ),
        vk::ImageLayout::GENERAL,
        true,
    );
    pub(super) const UNIFORM_READ: Self =
        Self::new(Self::SHADERS, vk::AccessFlags2::UNIFORM_READ, vk::ImageLayout::UNDEFINED, false);
    pub(super) const BUFFER_READ: Self =
        Self::new(Self::SHADERS, vk::AccessFlags2::SHADER_STORAGE_READ, vk::ImageLayout::UNDEFINED, false);
    pub(super) const BUFFER_WRITE: Self = Self::new(
        vk::PipelineStageFlags2::COMPUTE_SHADER,
        vk::AccessFlags2::SHADER_STORAGE_WRITE,
        vk::ImageLayout::UNDEFINED,
        true,
    );
    pub(super) const BUFFER_READ_WRITE: Self = Self::new(
        vk::PipelineStageFlags2::COMPUTE_SHADER,
        vk::AccessFlags2::from_raw(
            vk::AccessFlags2::SHADER_STORAGE_READ.as_raw() | vk::AccessFlags2::SHADER_STORAGE_WRITE.as_raw(),
        ),
        vk::ImageLayout::UNDEFINED,
        true,
    );
    pub(super) const VERTEX: Self = Self::new(
        vk::PipelineStageFlags2::VERTEX_ATTRIBUTE_INPUT,
        vk::AccessFlags2::VERTEX_ATTRIBUTE_READ,
        vk::ImageLayout::UNDEFINED,
        false,
    );
    pub(super) const INDEX: Self = Self::new(
        vk::PipelineStageFlags2::INDEX_INPUT,
        vk::AccessFlags2::INDEX_READ,
        vk::ImageLayout::UNDEFINED,
        false,
    );
    pub(super) const COPY_READ: Self = Self::new(
        vk::PipelineStageFlags2::COPY,
        vk::AccessFlags2::TRANSFER_READ,
        vk::ImageLayout::TRANSFER_SRC_OPTIMAL,
        false,
    );
    pub(super) const COPY_WRITE: Self = Self::new(
        vk::PipelineStageFlags2::COPY,
        vk::AccessFlags2::TRANSFER_WRITE,
        vk::ImageLayout::TRANSFER_DST_OPTIMAL,
        true,
    );
    /// vkCmdFillBuffer. The stage of a fill is COPY to some readers of the specification (validation layer 1.3.239 among them) and
    /// CLEAR to others: ALL_TRANSFER holds both.
    pub(super) const FILL: Self = Self::new(
        vk::PipelineStageFlags2::ALL_TRANSFER,
        vk::AccessFlags2::TRANSFER_WRITE,
        vk::ImageLayout::TRANSFER_DST_OPTIMAL,
        true,
    );
    pub(super) const COLOR: Self = Self::new(
        vk::PipelineStageFlags2::COLOR_ATTACHMENT_OUTPUT,
        vk::AccessFlags2::from_raw(
            vk::AccessFlags2::COLOR_ATTACHMENT_READ.as_raw() | vk::AccessFlags2::COLOR_ATTACHMENT_WRITE.as_raw(),
        ),
        vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL,
        true,
    );
    pub(super) const DEPTH: Self = Self::new(
        vk::PipelineStageFlags2::from_raw(
            vk::PipelineStageFlags2::EARLY_FRAGMENT_TESTS.as_raw()
                | vk::PipelineStageFlags2::LATE_FRAGMENT_TESTS.as_raw(),
        ),
        vk::AccessFlags2::from_raw(
            vk::AccessFlags2::DEPTH_STENCIL_ATTACHMENT_READ.as_raw()
                | vk::AccessFlags2::DEPTH_STENCIL_ATTACHMENT_WRITE.as_raw(),
        ),
        vk::ImageLayout::DEPTH_ATTACHMENT_OPTIMAL,
        true,
    );
    /// The host reads mapped memory after the submission.
    pub(super) const HOST_READ: Self =
        Self::new(vk::PipelineStageFlags2::HOST, vk::AccessFlags2::HOST_READ, vk::ImageLayout::UNDEFINED, false);
}

/// What happened to one resource (a buffer, a mip level) so far.
#[derive(Clone, Copy, Debug)]
pub(super) struct State {
    layout: vk::ImageLayout,
    write_stage: vk::PipelineStageFlags2,
    write_access: vk::AccessFlags2,
    /// Readers since that write: a later write waits for them, and they need no second barrier.
    read_stages: vk::PipelineStageFlags2,
    read_accesses: vk::AccessFlags2,
}

/// Source and destination of one barrier.
#[derive(Clone, Copy, Debug)]
pub(super) struct Barrier {
    pub(super) src_stage: vk::PipelineStageFlags2,
    pub(super) src_access: vk::AccessFlags2,
    pub(super) dst: Access,
    pub(super) old_layout: vk::ImageLayout,
}

impl State {
    pub(super) const NEW: Self = Self {
        layout: vk::ImageLayout::UNDEFINED,
        write_stage: vk::PipelineStageFlags2::NONE,
        write_access: vk::AccessFlags2::NONE,
        read_stages: vk::PipelineStageFlags2::NONE,
        read_accesses: vk::AccessFlags2::NONE,
    };

    /// Moves to `next` and returns the barrier that must come before it, if any.
    pub(super) fn advance(&mut self, next: Access, is_image: bool) -> Option<Barrier> {
        let old_layout = self.layout;
        let relayout = is_image && old_layout != next.layout;
        let barrier = if next.writes || relayout {
            // After a write and all reads of it. A layout transition writes, too.
            let src_stage = self.write_stage | self.read_stages;
            let src_access = if self.read_stages.is_empty() { self.write_access } else { vk::AccessFlags2::NONE };
            let needed = relayout || !src_stage.is_empty();
            self.read_stages = vk::PipelineStageFlags2::NONE;
            self.read_accesses = vk::AccessFlags2::NONE;
            self.write_stage = next.stage;
            self.write_access = if next.writes { next.access } else { vk::AccessFlags2::NONE };
            if !next.writes {
                self.read_stages = next.stage;
                self.read_accesses = next.access;
            }
            needed.then_some(Barrier { src_stage, src_access, dst: next, old_layout })
        } else {
            let known = self.read_stages.contains(next.stage) && self.read_accesses.contains(next.access);
            let needed = !known && !self.write_stage.is_empty();
            self.read_stages |= next.stage;
            self.read_accesses |= next.access;
            needed.then_some(Barrier {
                src_stage: self.write_stage,
                src_access: self.write_access,
                dst: next,
                old_layout,
            })
        };
        if is_image {
            self.layout = next.layout;
        }
        barrier
    }
}
