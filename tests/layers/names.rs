//! What one module's text says: which names it binds, which names it uses and on which line, which types it gives methods.

use proc_macro2::{Spacing, TokenStream, TokenTree};
use std::collections::{BTreeMap, BTreeSet};
use syn::visit::{self, Visit};
use syn::{Attribute, Item, ItemImpl, ItemMod, ItemUse, Type, UseTree, Visibility};

/// A path as it is written, and its line.
#[derive(Clone)]
pub struct Named {
    pub path: Vec<String>,
    pub line: usize,
}

/// An `impl T`: the type as it is written, and the functions in it.
pub struct Methods {
    pub of: Named,
    pub functions: BTreeSet<String>,
}

/// The text of a module, without the modules written inside it.
#[derive(Default)]
pub struct Text {
    /// What is defined here.
    pub items: BTreeSet<String>,
    /// What `use` binds here, and to which path.
    pub bound: BTreeMap<String, Vec<String>>,
    /// Paths that are named, re-exports aside.
    pub named: Vec<Named>,
    /// Paths that are re-exported.
    pub reexported: Vec<Named>,
    /// Single words in macros that stand where items stand: such a macro may be a list of children.
    pub listed: Vec<Named>,
    /// Functions that are called on something, by name.
    pub called: Vec<Named>,
    /// Every function that is defined here.
    pub functions: BTreeSet<String>,
    pub methods: Vec<Methods>,
    /// Lines with `*` of a module of this crate: they hide what is named.
    pub globs: Vec<usize>,
    /// Modules written inside this one, tests aside.
    pub inside: Vec<ItemMod>,
    /// Modules in files of their own that only tests have.
    pub only_for_tests: BTreeSet<String>,
}

impl Text {
    pub fn of(items: &[Item]) -> Self {
        let mut text = Self::default();
        for item in items {
            text.visit_item(item);
        }
        text
    }

    fn name(&mut self, path: Vec<String>, line: usize) {
        self.named.push(Named { path, line });
    }

    fn bind(&mut self, tree: &UseTree, before: &[String], reexported: bool) {
        let grown = |last: &syn::Ident| [before, &[last.to_string()]].concat();
        match tree {
            UseTree::Path(path) => self.bind(&path.tree, &grown(&path.ident), reexported),
            UseTree::Group(group) => group.items.iter().for_each(|tree| self.bind(tree, before, reexported)),
            UseTree::Name(name) => {
                let is_self = name.ident == "self";
                let path = if is_self { before.to_vec() } else { grown(&name.ident) };
                self.bind_as(path.last().cloned(), path, name.ident.span().start().line, reexported);
            }
            UseTree::Rename(rename) => {
                let name = Some(rename.rename.to_string());
                self.bind_as(name, grown(&rename.ident), rename.ident.span().start().line, reexported);
            }
            UseTree::Glob(glob) => {
                let inside = matches!(before.first().map(String::as_str), Some("crate" | "self" | "super"));
                self.globs.extend(inside.then(|| glob.star_token.spans[0].start().line));
            }
        }
    }

    fn bind_as(&mut self, name: Option<String>, path: Vec<String>, line: usize, reexported: bool) {
        if let Some(name) = name.filter(|name| name != "_") {
            self.bound.insert(name, path.clone());
        }
        let list = if reexported { &mut self.reexported } else { &mut self.named };
        list.push(Named { path, line });
    }

    /// The paths in tokens that only a macro understands: words joined by `::`, not behind a dot.
    fn scan(&mut self, tokens: TokenStream, is_item: bool) {
        let mut path: Vec<String> = Vec::new();
        let (mut line, mut half, mut joined, mut dotted) = (0, false, false, false);
        for token in tokens {
            match &token {
                TokenTree::Ident(word) if joined && !path.is_empty() => path.push(word.to_string()),
                TokenTree::Ident(word) => {
                    self.scanned(&mut path, line, is_item);
                    if !dotted {
                        (path, line) = (vec![word.to_string()], word.span().start().line);
                    } else {
                        self.called.push(Named { path: vec![word.to_string()], line: word.span().start().line });
                    }
                }
                TokenTree::Punct(point) if point.as_char() == ':' && half => {
                    (half, joined) = (false, true);
                    continue;
                }
                TokenTree::Punct(point) if point.as_char() == ':' && point.spacing() == Spacing::Joint => {
                    half = true;
                    continue;
                }
                TokenTree::Group(group) => {
                    self.scanned(&mut path, line, is_item);
                    self.scan(group.stream(), is_item);
                }
                TokenTree::Literal(literal) => {
                    self.scanned(&mut path, line, is_item);
                    self.literal(&literal.to_string(), literal.span().start().line);
                }
                TokenTree::Punct(_) => self.scanned(&mut path, line, is_item),
            }
            (half, joined) = (false, false);
            dotted = matches!(&token, TokenTree::Punct(point) if point.as_char() == '.');
        }
        self.scanned(&mut path, line, is_item);
    }

    /// What a macro defines when it is called: the words behind `struct` and its like.
    fn define(&mut self, tokens: TokenStream) {
        let mut before = String::new();
        for token in tokens {
            match &token {
                TokenTree::Ident(word) if matches!(before.as_str(), "const" | "enum" | "fn" | "struct" | "trait") => {
                    self.items.insert(word.to_string());
                }
                TokenTree::Group(group) => self.define(group.stream()),
                _ => {}
            }
            before = token.to_string();
        }
    }

    fn scanned(&mut self, path: &mut Vec<String>, line: usize, is_item: bool) {
        let path = std::mem::take(path);
        if is_item && path.len() == 1 {
            self.listed.push(Named { path: path.clone(), line });
        }
        if !path.is_empty() {
            self.name(path, line);
        }
    }

    /// serde is told functions as text: `with = "crate::hex"`.
    fn literal(&mut self, literal: &str, line: usize) {
        let path: Vec<String> = literal.trim_matches('"').split("::").map(str::to_owned).collect();
        if path.len() > 1 {
            self.name(path, line);
        }
    }
}

/// `#[cfg(test)]`, also with further conditions.
fn is_only_for_tests(attributes: &[Attribute]) -> bool {
    attributes.iter().filter(|attribute| attribute.path().is_ident("cfg")).any(|attribute| {
        let syn::Meta::List(list) = &attribute.meta else { return false };
        let condition = list.tokens.to_string();
        condition == "test" || condition.starts_with("all (test")
    })
}

fn attributes_of(item: &Item) -> &[Attribute] {
    match item {
        Item::Const(item) => &item.attrs,
        Item::Enum(item) => &item.attrs,
        Item::Fn(item) => &item.attrs,
        Item::Impl(item) => &item.attrs,
        Item::Macro(item) => &item.attrs,
        Item::Mod(item) => &item.attrs,
        Item::Static(item) => &item.attrs,
        Item::Struct(item) => &item.attrs,
        Item::Trait(item) => &item.attrs,
        Item::Type(item) => &item.attrs,
        Item::Use(item) => &item.attrs,
        _ => &[],
    }
}

/// The path of a type that is a path.
fn path_of(of: &Type) -> Option<Named> {
    let Type::Path(of) = of else { return None };
    let path = of.path.segments.iter().map(|segment| segment.ident.to_string()).collect();
    Some(Named { path, line: of.path.segments[0].ident.span().start().line })
}

impl<'ast> Visit<'ast> for Text {
    fn visit_item(&mut self, item: &'ast Item) {
        if is_only_for_tests(attributes_of(item)) {
            if let Item::Mod(module) = item {
                self.only_for_tests.insert(module.ident.to_string());
            }
            return;
        }
        let defined = match item {
            Item::Const(item) => Some(&item.ident),
            Item::Enum(item) => Some(&item.ident),
            Item::Fn(item) => Some(&item.sig.ident),
            Item::Static(item) => Some(&item.ident),
            Item::Struct(item) => Some(&item.ident),
            Item::Trait(item) => Some(&item.ident),
            Item::Type(item) => Some(&item.ident),
            Item::Macro(item) => item.ident.as_ref(),
            _ => None,
        };
        self.items.extend(defined.map(ToString::to_string));
        if let Item::Fn(function) = item {
            self.functions.insert(function.sig.ident.to_string());
        }
        visit::visit_item(self, item);
    }

    fn visit_item_mod(&mut self, module: &'ast ItemMod) {
        if module.content.is_some() {
            self.inside.push(module.clone());
        }
    }

    fn visit_item_use(&mut self, item: &'ast ItemUse) {
        self.bind(&item.tree, &[], !matches!(item.vis, Visibility::Inherited));
    }

    fn visit_item_impl(&mut self, block: &'ast ItemImpl) {
        let functions = block.items.iter().filter_map(|item| match item {
            syn::ImplItem::Fn(function) => Some(function.sig.ident.to_string()),
            _ => None,
        });
        let functions: BTreeSet<String> = functions.collect();
        self.functions.extend(functions.iter().cloned());
        if let (None, Some(of)) = (&block.trait_, path_of(&block.self_ty)) {
            self.methods.push(Methods { of, functions });
        }
        visit::visit_item_impl(self, block);
    }

    fn visit_trait_item_fn(&mut self, function: &'ast syn::TraitItemFn) {
        self.functions.insert(function.sig.ident.to_string());
        visit::visit_trait_item_fn(self, function);
    }

    fn visit_expr_method_call(&mut self, call: &'ast syn::ExprMethodCall) {
        self.called.push(Named { path: vec![call.method.to_string()], line: call.method.span().start().line });
        visit::visit_expr_method_call(self, call);
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        let segments: Vec<String> = path.segments.iter().map(|segment| segment.ident.to_string()).collect();
        let line = path.segments.first().map_or(0, |segment| segment.ident.span().start().line);
        if let [_, .., function] = &segments[..] {
            self.called.push(Named { path: vec![function.clone()], line });
        }
        self.name(segments, line);
        visit::visit_path(self, path);
    }

    fn visit_attribute(&mut self, attribute: &'ast Attribute) {
        if let (false, syn::Meta::List(list)) = (attribute.path().is_ident("doc"), &attribute.meta) {
            self.scan(list.tokens.clone(), false);
        }
    }

    fn visit_item_macro(&mut self, item: &'ast syn::ItemMacro) {
        if item.ident.is_some() {
            self.define(item.mac.tokens.clone());
        }
        self.scan(item.mac.tokens.clone(), item.ident.is_none());
        self.visit_path(&item.mac.path);
    }

    fn visit_macro(&mut self, invocation: &'ast syn::Macro) {
        self.scan(invocation.tokens.clone(), false);
        self.visit_path(&invocation.path);
    }
}
