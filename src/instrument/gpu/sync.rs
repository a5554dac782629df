//! Tracks the access of a buffer or mip level and derives the barrier that the next access needs.

use ash::vk::{AccessFlags2 as Kind, ImageLayout as Layout, PipelineStageFlags2 as Stage};

/// How a command uses a resource: stage, access, and the layout of an image; buffers have none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Access {
    pub(super) stage: Stage,
    pub(super) access: Kind,
    pub(super) layout: Layout,
    pub(super) writes: bool,
}

const STORAGE_READ_WRITE: Kind =
    Kind::from_raw(Kind::SHADER_STORAGE_READ.as_raw() | Kind::SHADER_STORAGE_WRITE.as_raw());
const COLOR_READ_WRITE: Kind =
    Kind::from_raw(Kind::COLOR_ATTACHMENT_READ.as_raw() | Kind::COLOR_ATTACHMENT_WRITE.as_raw());
const DEPTH_READ_WRITE: Kind = Kind::from_raw(
    Kind::DEPTH_STENCIL_ATTACHMENT_READ.as_raw() | Kind::DEPTH_STENCIL_ATTACHMENT_WRITE.as_raw(),
);
const SHADERS: Stage = Stage::from_raw(
    Stage::COMPUTE_SHADER.as_raw()
        | Stage::VERTEX_SHADER.as_raw()
        | Stage::FRAGMENT_SHADER.as_raw(),
);
const DEPTH_TESTS: Stage =
    Stage::from_raw(Stage::EARLY_FRAGMENT_TESTS.as_raw() | Stage::LATE_FRAGMENT_TESTS.as_raw());

impl Access {
    const fn read(stage: Stage, access: Kind, layout: Layout) -> Self {
        Self {
            stage,
            access,
            layout,
            writes: false,
        }
    }

    const fn write(stage: Stage, access: Kind, layout: Layout) -> Self {
        Self {
            stage,
            access,
            layout,
            writes: true,
        }
    }

    pub(super) const SAMPLE: Self = Self::read(
        SHADERS,
        Kind::SHADER_SAMPLED_READ,
        Layout::SHADER_READ_ONLY_OPTIMAL,
    );
    pub(super) const UNIFORM: Self = Self::read(SHADERS, Kind::UNIFORM_READ, Layout::UNDEFINED);
    pub(super) const LOAD: Self = Self::read(SHADERS, Kind::SHADER_STORAGE_READ, Layout::GENERAL);
    pub(super) const STORE: Self = Self::write(
        Stage::COMPUTE_SHADER,
        Kind::SHADER_STORAGE_WRITE,
        Layout::GENERAL,
    );
    pub(super) const UPDATE: Self =
        Self::write(Stage::COMPUTE_SHADER, STORAGE_READ_WRITE, Layout::GENERAL);
    pub(super) const VERTEX: Self = Self::read(
        Stage::VERTEX_ATTRIBUTE_INPUT,
        Kind::VERTEX_ATTRIBUTE_READ,
        Layout::UNDEFINED,
    );
    pub(super) const INDEX: Self =
        Self::read(Stage::INDEX_INPUT, Kind::INDEX_READ, Layout::UNDEFINED);
    pub(super) const COPY_READ: Self = Self::read(
        Stage::COPY,
        Kind::TRANSFER_READ,
        Layout::TRANSFER_SRC_OPTIMAL,
    );
    pub(super) const COPY_WRITE: Self = Self::write(
        Stage::COPY,
        Kind::TRANSFER_WRITE,
        Layout::TRANSFER_DST_OPTIMAL,
    );
    /// vkCmdFillBuffer. Its stage is COPY to some readers of the specification (validation layer
    /// 1.3.239 among them) and CLEAR to others: ALL_TRANSFER includes both.
    pub(super) const FILL: Self = Self::write(
        Stage::ALL_TRANSFER,
        Kind::TRANSFER_WRITE,
        Layout::TRANSFER_DST_OPTIMAL,
    );
    pub(super) const COLOR: Self = Self::write(
        Stage::COLOR_ATTACHMENT_OUTPUT,
        COLOR_READ_WRITE,
        Layout::COLOR_ATTACHMENT_OPTIMAL,
    );
    pub(super) const DEPTH: Self = Self::write(
        DEPTH_TESTS,
        DEPTH_READ_WRITE,
        Layout::DEPTH_ATTACHMENT_OPTIMAL,
    );
    /// The window's system reads the image; a semaphore makes it wait.
    #[cfg(feature = "view")]
    pub(super) const PRESENT: Self = Self::read(Stage::NONE, Kind::NONE, Layout::PRESENT_SRC_KHR);
    /// Host reads of mapped memory after the submission.
    pub(super) const HOST_READ: Self = Self::read(Stage::HOST, Kind::HOST_READ, Layout::UNDEFINED);
}

/// Past accesses of one buffer or mip level.
#[derive(Clone, Copy, Debug)]
pub(super) struct State {
    layout: Layout,
    write_stage: Stage,
    write_access: Kind,
    /// Reads since that write: a later write waits for them, and they need no second barrier.
    read_stages: Stage,
    read_accesses: Kind,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Barrier {
    pub(super) src_stage: Stage,
    pub(super) src_access: Kind,
    pub(super) dst: Access,
    pub(super) old_layout: Layout,
}

impl State {
    pub(super) const NEW: Self = Self {
        layout: Layout::UNDEFINED,
        write_stage: Stage::NONE,
        write_access: Kind::NONE,
        read_stages: Stage::NONE,
        read_accesses: Kind::NONE,
    };

    /// An image of a window that was acquired, with undefined contents. The semaphore of the
    /// acquisition is waited for by its first writes, so the first barrier must come after it.
    #[cfg(feature = "view")]
    pub(super) const ACQUIRED: Self = Self {
        write_stage: Stage::COLOR_ATTACHMENT_OUTPUT,
        ..Self::NEW
    };

    /// Moves to `next` and returns the barrier that must precede it, if any.
    pub(super) fn advance(&mut self, next: Access, is_image: bool) -> Option<Barrier> {
        let relayout = is_image && self.layout != next.layout;
        let after_write = Barrier {
            src_stage: self.write_stage,
            src_access: self.write_access,
            dst: next,
            old_layout: self.layout,
        };
        if is_image {
            self.layout = next.layout;
        }
        if !next.writes && !relayout {
            let known =
                self.read_stages.contains(next.stage) && self.read_accesses.contains(next.access);
            self.read_stages |= next.stage;
            self.read_accesses |= next.access;
            return (!known && !self.write_stage.is_empty()).then_some(after_write);
        }
        // Waits for a write and all reads after it. A layout transition is a write too.
        let src_stage = self.write_stage | self.read_stages;
        let src_access = if self.read_stages.is_empty() {
            self.write_access
        } else {
            Kind::NONE
        };
        self.write_stage = next.stage;
        (self.write_access, self.read_stages, self.read_accesses) = if next.writes {
            (next.access, Stage::NONE, Kind::NONE)
        } else {
            (Kind::NONE, next.stage, next.access)
        };
        (relayout || !src_stage.is_empty()).then_some(Barrier {
            src_stage,
            src_access,
            ..after_write
        })
    }
}
