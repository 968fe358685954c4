//! What no tree and no ray on its way through one goes beyond: the builder and the kernel each keep to
//! their part, and rely on the other's.

use super::node::WIDTH;

/// Levels of nodes that no tree has more of; the builder sees to that.
pub(super) const MAX_DEPTH: usize = 96;
/// Entries that the stack of a traversal needs: its end, and each level takes one and leaves up to
/// eight, which are always written.
pub(super) const STACK_SIZE: usize = 1 + (WIDTH - 1) * MAX_DEPTH + 2 * WIDTH;
/// Leaves with candidates that a slot can hold.
pub(super) const MAX_CANDIDATE_LEAVES: usize = 16;
