//! Limits of trees and traversals. The builder and the kernel each guarantee some and rely on the
//! others.

use super::node::WIDTH;

/// Maximum depth of a tree in nodes, guaranteed by the builder.
pub(super) const MAX_DEPTH: usize = 96;
/// Entries of the traversal stack: the end marker, and each level pops one and pushes up to eight,
/// which are always written.
pub(super) const STACK_SIZE: usize = 1 + (WIDTH - 1) * MAX_DEPTH + 2 * WIDTH;
/// Maximum number of leaves with candidates per ray.
pub(super) const MAX_CANDIDATE_LEAVES: usize = 16;
