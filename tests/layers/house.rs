//! A crate as its folders show it: every file a module, every name led to the file that defines it.

use crate::names::{Named, Text};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use tests::workspace::{root, sources, text};

/// Re-exports of re-exports: more than anybody writes, less than forever.
const LONGEST_CHAIN: usize = 8;

struct Module {
    /// The file that it stands in, among [`House::files`].
    file: usize,
    text: Text,
}

/// A file and the module that it is.
pub struct File {
    /// From the workspace's root.
    pub name: PathBuf,
    /// `["twin", "effect"]` for `src/twin/effect.rs`; empty for the crate's first file.
    pub module: Vec<String>,
    pub lines: usize,
}

/// One file names what another one defines.
pub struct Arrow {
    pub from: usize,
    pub to: usize,
    pub line: usize,
    /// What is named.
    pub name: String,
}

/// An `impl` of a type in the crate.
pub struct Impl {
    pub file: usize,
    pub line: usize,
    pub of: String,
    /// Where the type is defined.
    pub defined_in: usize,
    functions: BTreeSet<String>,
}

/// A crate.
pub struct House {
    pub files: Vec<File>,
    pub arrows: Vec<Arrow>,
    modules: BTreeMap<Vec<String>, Module>,
}

/// What a path leads to.
enum Place {
    Module(Vec<String>),
    /// Something that this file defines.
    Item(usize),
}

impl House {
    /// Every file below `folder/src` that is not for tests alone.
    pub fn read(folder: &str) -> Self {
        let src = root().join(folder).join("src");
        let mut house = Self { files: Vec::new(), arrows: Vec::new(), modules: BTreeMap::new() };
        let mut parsed = BTreeMap::new();
        for path in sources(&format!("{folder}/src")) {
            let source = text(&path);
            let file = syn::parse_file(&source).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
            let module = module_of(path.strip_prefix(&src).expect("a file below its folder"));
            parsed.insert(module, (path, source.lines().count(), Text::of(&file.items)));
        }
        let only_for_tests: BTreeSet<Vec<String>> = parsed
            .iter()
            .flat_map(|(module, (_, _, text))| text.only_for_tests.iter().map(|name| child(module, name)))
            .collect();
        for (module, (path, lines, text)) in parsed {
            if !(1..=module.len()).any(|depth| only_for_tests.contains(&module[..depth])) {
                let name = path.strip_prefix(root()).unwrap_or(&path).to_owned();
                house.files.push(File { name, module: module.clone(), lines });
                house.add(module, house.files.len() - 1, text);
            }
        }
        house.arrows = house.find_arrows();
        house
    }

    fn add(&mut self, path: Vec<String>, file: usize, mut text: Text) {
        if let Some(line) = text.globs.first() {
            panic!("{}:{line}: `*` hides what is named: name it", self.files[file].name.display());
        }
        for inside in std::mem::take(&mut text.inside) {
            let items = inside.content.as_ref().map_or(&[][..], |(_, items)| items);
            self.add(child(&path, &inside.ident.to_string()), file, Text::of(items));
        }
        self.modules.insert(path, Module { file, text });
    }

    /// Every place where one file names what another one defines.
    fn find_arrows(&self) -> Vec<Arrow> {
        let mut arrows = Vec::new();
        for (path, module) in &self.modules {
            let mut add = |to: usize, named: &Named| {
                if to != module.file {
                    arrows.push(Arrow { from: module.file, to, line: named.line, name: named.path.join("::") });
                }
            };
            for named in &module.text.named {
                if let Some(Place::Item(to)) = self.find(path, &named.path, 0) {
                    add(to, named);
                }
            }
            // A file may show what is below it. Showing anything else is depending on it.
            for named in &module.text.reexported {
                if let Some(Place::Item(to)) = self.find(path, &named.path, 0)
                    && !self.files[to].module.starts_with(path)
                {
                    add(to, named);
                }
            }
            for listed in &module.text.listed {
                if let Some(Place::Module(module)) = self.find(path, &listed.path, 0) {
                    add(self.modules[&module].file, listed);
                }
            }
        }
        arrows.extend(self.calls_of_methods_apart());
        arrows
    }

    /// Calls of methods that are not written in the file of their type: no path names the file that they lead to.
    fn calls_of_methods_apart(&self) -> Vec<Arrow> {
        let apart: Vec<Impl> = self.impls().into_iter().filter(|block| block.file != block.defined_in).collect();
        let mut written: BTreeMap<&str, usize> = BTreeMap::new();
        for function in self.modules.values().flat_map(|module| &module.text.functions) {
            *written.entry(function).or_default() += 1;
        }
        let mut arrows = Vec::new();
        for (path, module) in &self.modules {
            for called in &module.text.called {
                let name = &called.path[0];
                let of = apart.iter().find(|block| block.functions.contains(name) && written[name.as_str()] == 1);
                // Other types have functions of this name too; who knows nothing of the type doesn't call its.
                let knows =
                    |block: &&Impl| module.file == block.defined_in || self.names(path, module, block.defined_in);
                if let Some(block) = of.filter(|block| block.file != module.file).filter(knows) {
                    let name = format!("{}::{name}", block.of);
                    arrows.push(Arrow { from: module.file, to: block.file, line: called.line, name });
                }
            }
        }
        arrows
    }

    fn names(&self, path: &[String], module: &Module, file: usize) -> bool {
        let mut places = module.text.named.iter().filter_map(|named| self.find(path, &named.path, 0));
        places.any(|place| matches!(place, Place::Item(to) if to == file))
    }

    /// Every `impl` of a type of this crate that gives it methods of its own.
    pub fn impls(&self) -> Vec<Impl> {
        let mut impls = Vec::new();
        for (path, module) in &self.modules {
            for block in &module.text.methods {
                if let Some(Place::Item(defined_in)) = self.find(path, &block.of.path, 0) {
                    let (of, line, functions) = (block.of.path.join("::"), block.of.line, block.functions.clone());
                    impls.push(Impl { file: module.file, line, of, defined_in, functions });
                }
            }
        }
        impls
    }

    /// Where a path leads to that is written in `from`; nothing if it leads out of the crate.
    fn find(&self, from: &[String], path: &[String], chain: usize) -> Option<Place> {
        let (first, mut rest) = path.split_first()?;
        let mut here = match first.as_str() {
            "crate" => Vec::new(),
            "self" => from.to_vec(),
            "super" => from[..from.len().checked_sub(1)?].to_vec(),
            _ => {
                rest = path;
                from.to_vec()
            }
        };
        while let Some((name, after)) = rest.split_first() {
            if name == "super" {
                here.pop()?;
            } else {
                // A function may have the name of its module: what comes last is the function.
                let deeper = child(&here, name);
                let place = if after.is_empty() { self.item(&here, name, chain) } else { None };
                match place.or_else(|| self.modules.contains_key(&deeper).then_some(Place::Module(deeper))) {
                    Some(Place::Module(module)) => here = module,
                    Some(item) => return Some(item),
                    None => match self.item(&here, name, chain)? {
                        Place::Module(module) => here = module,
                        item => return Some(item),
                    },
                }
            }
            rest = after;
        }
        Some(Place::Module(here))
    }

    /// What a module means by a name that is not a child's.
    fn item(&self, module: &[String], name: &str, chain: usize) -> Option<Place> {
        let Module { file, text } = self.modules.get(module)?;
        if text.items.contains(name) {
            return Some(Place::Item(*file));
        }
        match text.bound.get(name) {
            Some(path) if chain < LONGEST_CHAIN => self.find(module, path, chain + 1),
            _ => self.made_by_a_macro(module, name),
        }
    }

    /// A list that is a macro re-exports what no line of it shows.
    fn made_by_a_macro(&self, module: &[String], name: &str) -> Option<Place> {
        let text = &self.modules.get(module)?.text;
        let listed = text.listed.iter().map(|listed| child(module, &listed.path[0]));
        let mut children = listed.filter_map(|path| self.modules.get(&path));
        children.find(|child| child.text.items.contains(name)).map(|child| Place::Item(child.file))
    }
}

fn child(module: &[String], name: &str) -> Vec<String> {
    [module, &[name.to_owned()]].concat()
}

fn module_of(file: &Path) -> Vec<String> {
    let path = file.with_extension("");
    let mut names: Vec<String> = path.iter().map(|part| part.to_string_lossy().into_owned()).collect();
    if names.last().is_some_and(|last| matches!(last.as_str(), "lib" | "main" | "mod")) {
        names.pop();
    }
    names
}
