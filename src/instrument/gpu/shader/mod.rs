//! SPIR-V by permutation name: from the build script, of an edited folder of shaders, and of
//! methods in files, both compiled at run time.

mod edited;

pub use edited::{EditedShaders, has_edited_shaders};

use super::GpuError;
use crate::base::glsl::source::Sources;
use edited::{in_use, texts_in_use};
use rspirv_reflect::rspirv::dr::{self, Function, Instruction, Operand};
use rspirv_reflect::spirv::Op;
use rspirv_reflect::{ReflectError, Reflection};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::{LazyLock, PoisonError, RwLock};

include!(concat!(env!("OUT_DIR"), "/shaders.rs"));

/// Shaders compiled at run time. They are never removed, since pipelines may be made at any time.
static ADDED: RwLock<BTreeMap<String, &'static [u8]>> = RwLock::new(BTreeMap::new());

/// Finds the SPIR-V of the permutation `name` (see `shaders/compile.rs`).
pub(super) fn code_of(name: &str) -> Option<&'static [u8]> {
    let known = in_use()
        .iter()
        .find(|(known, _)| *known == name)
        .map(|(_, code)| *code);
    // A panic cannot leave the map half-changed: entries are added in one step.
    known.or_else(|| {
        ADDED
            .read()
            .unwrap_or_else(PoisonError::into_inner)
            .get(name)
            .copied()
    })
}

/// Adds a permutation at run time. `name` must contain a hash of its text: a second code under that
/// name is ignored.
pub fn add_shader(name: String, code: &[u32]) {
    let mut added = ADDED.write().unwrap_or_else(PoisonError::into_inner);
    added
        .entry(name)
        .or_insert_with(|| Box::leak(bytemuck::cast_slice(code).to_vec().into_boxed_slice()));
}

/// Returns the SPIR-V words of a permutation added at run time.
pub fn added_shader(name: &str) -> Option<Vec<u32>> {
    let added = ADDED.read().unwrap_or_else(PoisonError::into_inner);
    added
        .get(name)
        .map(|code| bytemuck::pod_collect_to_vec(code))
}

pub fn shader_sources() -> Sources {
    Sources(
        texts_in_use()
            .iter()
            .map(|(path, text)| (path.to_string(), text.to_string()))
            .collect(),
    )
}

/// Lists the names that `function` of a shader reads, directly or in functions that it calls:
/// variables (blocks without a name by the block's name) and members of structs.
pub fn names_read(shader: &str, function: &str) -> Result<BTreeSet<String>, GpuError> {
    let fault = |error: ReflectError| GpuError::Reflection {
        shader: shader.to_owned(),
        what: error.to_string(),
    };
    Ok(Module(
        Reflection::new_from_spirv(shader_code(shader))
            .map_err(fault)?
            .0,
    )
    .names_read(function))
}

struct Module(dr::Module);

impl Module {
    fn called_by(&self, function: &str) -> Vec<&Function> {
        let id_of = |function: &Function| function.def.as_ref().and_then(|def| def.result_id);
        // In SPIR-V the parameter types follow a function's name.
        let is_it = |f: &&Function| {
            let name = id_of(f).and_then(|id| self.name(Op::Name, id, None));
            name.is_some_and(|name| name.split('(').next() == Some(function))
        };
        let mut found: Vec<&Function> = self.0.functions.iter().filter(is_it).collect();
        let mut next = 0;
        while let Some(caller) = found.get(next) {
            let calls = caller
                .all_inst_iter()
                .filter(|i| i.class.opcode == Op::FunctionCall);
            let called: Vec<Option<u32>> =
                calls.map(|call| call.operands[0].id_ref_any()).collect();
            for function in self
                .0
                .functions
                .iter()
                .filter(|f| called.contains(&id_of(f)))
            {
                if !found.iter().any(|known| id_of(known) == id_of(function)) {
                    found.push(function);
                }
            }
            next += 1;
        }
        found
    }

    fn names_read(&self, function: &str) -> BTreeSet<String> {
        let ids = Ids::new(self);
        let mut names = BTreeSet::new();
        for instruction in self
            .called_by(function)
            .into_iter()
            .flat_map(Function::all_inst_iter)
        {
            names.extend(ids.variables(instruction));
            ids.add_members(instruction, &mut names);
        }
        names
    }

    /// Returns the name of an id or of one of its members; `None` if it has none.
    fn name(&self, kind: Op, id: u32, member: Option<u32>) -> Option<String> {
        let is_it = |name: &&Instruction| {
            let target = name.operands[0].id_ref_any() == Some(id);
            let at = member.is_none_or(
                |member| matches!(name.operands[1], Operand::LiteralBit32(at) if at == member),
            );
            name.class.opcode == kind && target && at
        };
        match self.0.debug_names.iter().find(is_it)?.operands.last()? {
            Operand::LiteralString(name) if !name.is_empty() => Some(name.clone()),
            _ => None,
        }
    }
}

/// The instructions of a module by the id of their result.
struct Ids<'m> {
    module: &'m Module,
    by_id: BTreeMap<u32, &'m Instruction>,
}

impl<'m> Ids<'m> {
    fn new(module: &'m Module) -> Self {
        let globals = module.0.types_global_values.iter();
        let by_id = globals
            .chain(module.0.all_inst_iter())
            .filter_map(|i| Some((i.result_id?, i)))
            .collect();
        Self { module, by_id }
    }

    fn pointee(&self, pointer: u32) -> u32 {
        self.by_id[&pointer].operands[1].unwrap_id_ref()
    }

    /// Returns the names of the variables among an instruction's operands: the name of the type
    /// for a block without its own.
    fn variables(&self, instruction: &Instruction) -> impl Iterator<Item = String> {
        let ids = instruction.operands.iter().filter_map(Operand::id_ref_any);
        ids.filter_map(|id| {
            let variable = self
                .by_id
                .get(&id)
                .filter(|found| found.class.opcode == Op::Variable)?;
            let pointer = variable.result_type?;
            let name_of = |id: u32| self.module.name(Op::Name, id, None);
            name_of(id).or_else(|| name_of(self.pointee(pointer)))
        })
    }

    /// Adds the names of members on an instruction's path into a struct: by number, from the type
    /// of the base.
    fn add_members(&self, instruction: &Instruction, names: &mut BTreeSet<String>) {
        let base = instruction.operands.first().and_then(Operand::id_ref_any);
        let Some(mut of_type) = base.and_then(|base| self.by_id.get(&base)?.result_type) else {
            return;
        };
        match instruction.class.opcode {
            Op::AccessChain | Op::InBoundsAccessChain => of_type = self.pointee(of_type),
            Op::CompositeExtract => {}
            _ => return,
        }
        for step in &instruction.operands[1..] {
            let parts = &self.by_id[&of_type];
            match (parts.class.opcode, self.number(step)) {
                (Op::TypeStruct, Some(member)) => {
                    names.extend(self.module.name(Op::MemberName, of_type, Some(member)));
                    of_type = parts.operands[member as usize].unwrap_id_ref();
                }
                // The element type of an array, vector or matrix.
                _ => match parts.operands.first() {
                    Some(Operand::IdRef(element)) => of_type = *element,
                    _ => break,
                },
            }
        }
    }

    /// Returns the number that an operand is or whose constant it names.
    fn number(&self, operand: &Operand) -> Option<u32> {
        if let Operand::LiteralBit32(number) = operand {
            return Some(*number);
        }
        let constant = self.by_id[&operand.id_ref_any()?];
        match constant.operands.first() {
            Some(Operand::LiteralBit32(number)) if constant.class.opcode == Op::Constant => {
                Some(*number)
            }
            _ => None,
        }
    }
}

/// Returns whether the permutation exists. Methods that do not use the BRDF have no permutation per
/// model.
pub fn has_shader(name: &str) -> bool {
    code_of(name).is_some()
}

/// Hashes the code of these permutations, as `spirv` returns it.
pub fn code_hash<'a>(shaders: &[String], spirv: impl Fn(&str) -> &'a [u8]) -> String {
    let mut hasher = blake3::Hasher::new();
    for name in shaders {
        let code = spirv(name);
        // With its length, the end of one shader cannot pass for the start of the next.
        hasher
            .update(&(name.len() as u64).to_le_bytes())
            .update(name.as_bytes());
        hasher
            .update(&(code.len() as u64).to_le_bytes())
            .update(code);
    }
    hasher.finalize().to_hex().to_string()
}

/// Returns the SPIR-V of the permutation `name`. Panics if there is none.
pub fn shader_code(name: &str) -> &'static [u8] {
    code_of(name).unwrap_or_else(|| panic!("there is no shader {name}"))
}

pub fn shader_names() -> impl Iterator<Item = &'static str> {
    in_use().iter().map(|(name, _)| *name)
}

/// Hashes all shaders that make results: not those that paint the window.
pub fn build_hash() -> &'static str {
    // Cached: a plan asks for it once per cell.
    static HASH: LazyLock<String> = LazyLock::new(|| {
        let mut hasher = blake3::Hasher::new();
        let makes_results = |(name, _): &&(&str, &[u8])| !name.starts_with("window/");
        for (name, bytes) in in_use().iter().filter(makes_results) {
            hasher.update(name.as_bytes());
            hasher.update(bytes);
        }
        hasher.finalize().to_hex().to_string()
    });
    &HASH
}
