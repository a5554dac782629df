//! Import cycles at every depth: among the files and folders of each folder.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

/// A module's file, and every path from the crate's root in its code.
type Modules = BTreeMap<Vec<String>, (PathBuf, BTreeSet<Vec<String>>)>;

/// References between children of one folder, each with the files that make them.
type Edges<'m> = BTreeMap<&'m str, BTreeMap<&'m str, BTreeSet<String>>>;

/// The first cycle, as lines that say which file names which module; `None` without a cycle.
///
/// References from a module to items of its own folder do not count: only children of one folder
/// are compared.
pub fn first_circle(modules: &Modules) -> Option<String> {
    let folders: BTreeSet<&[String]> = modules
        .keys()
        .flat_map(|module| (0..module.len()).map(|n| &module[..n]))
        .collect();
    folders.into_iter().find_map(|folder| {
        let edges = edges(modules, folder);
        let circle = circle(&edges)?;
        let lines = edges
            .iter()
            .filter(|(from, _)| circle.contains(**from))
            .flat_map(|(_, targets)| {
                targets
                    .iter()
                    .filter(|(to, _)| circle.contains(**to))
                    .flat_map(|(_, files)| files.iter().cloned())
            });
        Some(format!(
            "a circle in {:?}:\n{}",
            folder.join("::"),
            lines.collect::<Vec<_>>().join("\n")
        ))
    })
}

fn edges<'m>(modules: &'m Modules, folder: &[String]) -> Edges<'m> {
    let depth = folder.len();
    let mut edges = Edges::new();
    for (module, (file, paths)) in modules
        .iter()
        .filter(|(module, _)| module.len() > depth && module.starts_with(folder))
    {
        for path in paths.iter().filter(|path| {
            path.len() > depth && path.starts_with(folder) && path[depth] != module[depth]
        }) {
            // A path may end in an item; a path without a module of the folder is an item of the
            // folder itself.
            let is_module = modules
                .keys()
                .any(|other| other.len() > depth && other[..=depth] == path[..=depth]);
            if is_module {
                let line = format!("{} names {}", file.display(), path.join("::"));
                edges
                    .entry(&module[depth])
                    .or_default()
                    .entry(&path[depth])
                    .or_default()
                    .insert(line);
            }
        }
    }
    edges
}

/// Nodes that reach each other: the first strongly connected component of more than one.
fn circle<'m>(edges: &Edges<'m>) -> Option<BTreeSet<&'m str>> {
    let reached = |from: &'m str| {
        let (mut seen, mut open) = (BTreeSet::new(), vec![from]);
        while let Some(node) = open.pop() {
            let next = edges
                .get(node)
                .into_iter()
                .flat_map(|targets| targets.keys().copied());
            open.extend(next.filter(|node| seen.insert(*node)));
        }
        seen
    };
    let reach: BTreeMap<&str, BTreeSet<&str>> =
        edges.keys().map(|node| (*node, reached(node))).collect();
    let start = reach
        .iter()
        .find(|(node, seen)| seen.contains(**node))
        .map(|(node, _)| *node)?;
    let is_back = |node: &&str| reach.get(node).is_some_and(|seen| seen.contains(start));
    Some(reach[start].iter().copied().filter(is_back).collect())
}
