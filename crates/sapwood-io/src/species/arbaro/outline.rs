//! A look at the tags of an XML text before anything is built from it.
//!
//! It refuses what no species file needs and what makes documents dear to build: a document type
//! declaration, deep nesting, and long lists of attributes. It takes one pass and no memory. What
//! it cannot make sense of it leaves to the parser, which says more about it.

use crate::ErrorKind;

/// How deep elements may be nested; a species file has three levels of them.
pub(super) const MAX_DEPTH: usize = 8;
/// How many attributes an element may have; a parameter has two.
pub(super) const MAX_ATTRIBUTES: usize = 16;

/// Where a text breaks off: inside an element that is not closed, or inside a tag or comment.
#[derive(Debug, PartialEq)]
pub(super) struct BreaksOff {
    /// The byte where the innermost part that has no end begins.
    pub(super) part: usize,
    /// The first byte at which an error of the parser comes from the missing end.
    pub(super) from: usize,
}

/// Finds where `text` breaks off, if it does, or else why it is refused and at which byte.
pub(super) fn outline(text: &str) -> Result<Option<BreaksOff>, (ErrorKind, usize)> {
    let mut open: [usize; MAX_DEPTH] = [0; MAX_DEPTH];
    let mut depth = 0;
    let mut at = 0;
    while let Some(next) = text[at..].find('<') {
        at += next;
        let rest = &text[at..];
        let length = if rest.starts_with("<!--") {
            end_of(rest, 4, "-->")
        } else if rest.starts_with("<![CDATA[") {
            end_of(rest, 9, "]]>")
        } else if rest.starts_with("<?") {
            end_of(rest, 2, "?>")
        } else if rest.starts_with("<!DOCTYPE") {
            return Err((ErrorKind::DocumentType, at));
        } else if rest.starts_with("<!") {
            let is_begun = ["<!--", "<![CDATA[", "<!DOCTYPE"].iter().any(|t| t.starts_with(rest));
            return Ok(is_begun.then_some(BreaksOff { part: at, from: at }));
        } else if rest.starts_with("</") {
            depth = match usize::checked_sub(depth, 1) {
                Some(depth) => depth,
                None => return Ok(None),
            };
            end_of(rest, 2, ">")
        } else {
            match start_tag(rest) {
                Tag::Whole { length, n_attributes, is_empty } => {
                    if n_attributes > MAX_ATTRIBUTES {
                        return Err((too_many(rest), at));
                    }
                    if !is_empty {
                        if depth == MAX_DEPTH {
                            return Err((ErrorKind::TooDeep { limit: MAX_DEPTH }, at));
                        }
                        open[depth] = at;
                        depth += 1;
                    }
                    Some(length)
                }
                Tag::BreaksOff => None,
                Tag::Broken => return Ok(None),
            }
        };
        match length {
            Some(length) => at += length,
            None => return Ok(Some(BreaksOff { part: at, from: at })),
        }
    }
    Ok(open[..depth].last().map(|part| BreaksOff { part: *part, from: text.len() }))
}

/// The length of what ends with `end`, looked for after its first `skip` bytes.
fn end_of(rest: &str, skip: usize, end: &str) -> Option<usize> {
    rest[skip..].find(end).map(|found| skip + found + end.len())
}

enum Tag {
    /// From `<` to `>`; whether the element ends with the tag.
    Whole {
        length: usize,
        n_attributes: usize,
        is_empty: bool,
    },
    BreaksOff,
    /// Another tag begins inside it.
    Broken,
}

fn start_tag(rest: &str) -> Tag {
    let mut quote = None;
    let mut n_attributes = 0;
    for (i, byte) in rest.bytes().enumerate().skip(1) {
        match (byte, quote) {
            (b'<', _) => return Tag::Broken,
            (b'"' | b'\'', None) => quote = Some(byte),
            (_, Some(open)) if byte == open => {
                quote = None;
                n_attributes += 1;
            }
            (b'>', None) => {
                let is_empty = rest.as_bytes()[i - 1] == b'/';
                return Tag::Whole { length: i + 1, n_attributes, is_empty };
            }
            _ => {}
        }
    }
    Tag::BreaksOff
}

fn too_many(tag: &str) -> ErrorKind {
    ErrorKind::Unexpected {
        found: format!("number of attributes above {MAX_ATTRIBUTES}"),
        within: super::element(tag_name(tag)),
        accepted: format!("up to {MAX_ATTRIBUTES}"),
    }
}

/// What begins where `rest` begins, in words for messages.
pub(super) fn part(rest: &str) -> String {
    let has_begun =
        |whole: &str| rest.starts_with(whole) || rest.len() > 1 && whole.starts_with(rest);
    match rest {
        _ if has_begun("<!--") => "a comment".to_owned(),
        _ if has_begun("<?") => "a processing instruction".to_owned(),
        _ if has_begun("</") => "a closing tag".to_owned(),
        _ if rest.starts_with("<!") => "a declaration".to_owned(),
        _ => super::element(tag_name(rest)),
    }
}

/// The name in the text of a tag.
fn tag_name(tag: &str) -> &str {
    let name = tag.trim_start_matches('<');
    name.split(|c: char| c.is_whitespace() || matches!(c, '>' | '/')).next().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn breaks_off(text: &str) -> Option<usize> {
        outline(text).unwrap_or_else(|(kind, _)| panic!("{kind}")).map(|off| off.part)
    }

    #[test]
    fn whole_texts_do_not_break_off() {
        for text in [
            "",
            "no tags",
            "<a/>",
            "<a><b c='>' d=\"/>\"></b><!-- <x> --><?y <z ?><![CDATA[<w>]]></a >",
            // Left to the parser.
            "</a>",
            "<!ELEMENT a>",
            "<a b='<c>",
        ] {
            assert_eq!(breaks_off(text), None, "{text}");
        }
    }

    #[test]
    fn the_innermost_part_without_an_end_is_found() {
        let check = |text, at| assert_eq!(breaks_off(text), Some(at), "{text}");
        check("<", 0);
        check("<a", 0);
        check("<a>", 0);
        check("<a><b/><c d='e", 7);
        check("<a><b></b", 3 + 3);
        check("<a><b></b>", 0);
        check("<a><b> text", 3);
        check("<a><!-- -", 3);
        check("<a><!-", 3);
        check("<!DOC", 0);
        assert_eq!(outline("<a><b").ok().flatten(), Some(BreaksOff { part: 3, from: 3 }));
        assert_eq!(outline("<a><b>").ok().flatten(), Some(BreaksOff { part: 3, from: 6 }));
        check("<?xml version='1.0'", 0);
    }

    #[test]
    fn parts_have_names() {
        let check = |rest, name| assert_eq!(part(rest), name, "{rest}");
        check("<", "<>");
        check("<param name='", "<param>");
        check("<a/><b>", "<a>");
        check("</spe", "a closing tag");
        check("<!", "a comment");
        check("<!-- <a>", "a comment");
        check("<![CDATA[", "a declaration");
        check("<?xml", "a processing instruction");
    }

    #[test]
    fn what_is_dear_is_refused_where_it_stands() {
        let check = |text: &str, message: &str, at| {
            let (kind, found) = outline(text).err().unwrap();
            assert_eq!((kind.to_string().as_str(), found), (message, at), "{text}");
        };
        let eight = "<a>".repeat(8);
        assert_eq!(breaks_off(&eight), Some(7 * 3));
        check(&format!("{eight}<b>"), "elements are nested more than 8 deep", 24);
        assert_eq!(breaks_off(&format!("{eight}<b/>{}", "</a>".repeat(8))), None);
        let many = format!("<x {}/>", "a='' ".repeat(17));
        check(&many, "unexpected number of attributes above 16 in <x> (accepted: up to 16)", 0);
        assert_eq!(breaks_off(&many.replacen("a=''", "", 1)), None);
        let doctype = "<!-- <!DOCTYPE a> --> <!DOCTYPE a [";
        let message =
            "a document type declaration is refused; entities and external files are not read";
        check(doctype, message, 22);
    }
}
