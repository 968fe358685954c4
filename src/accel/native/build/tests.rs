use super::*;
use crate::accel::native::limits::MAX_DEPTH;
use crate::accel::native::node::WIDTH;
use crate::geometry::SphereRows;
use crate::task::{CancelToken, ProgressCallback};

fn scattered(count: u32) -> Vec<[f32; 4]> {
    let wave = |i: u32, k: u32| (i.wrapping_mul(k) % 100_003) as f32 / 100_003.0;
    let sphere =
        |i| [wave(i, 48_271), wave(i, 69_621), wave(i, 39_373), 1e-3 * (0.1 + wave(i, 16_807))];
    (0..count).map(sphere).collect()
}

fn set(table: Vec<[f32; 4]>) -> SphereSet {
    SphereSet::new(SphereRows { exact: Vec::new(), table }).expect("few spheres")
}

fn tree_on(threads: usize, set: &SphereSet, quality: BuildQuality) -> (Bvh, BuildStats) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
    let options = BuildOptions { quality, ..Default::default() };
    pool.install(|| build(set, &options)).expect("not cancelled")
}

/// The depth of the tree at a child, including its own node.
fn depth(tree: &Bvh, child: NodeRef) -> usize {
    if child.is_leaf() {
        return 0;
    }
    let node = &tree.nodes()[child.index()];
    let used = (0..WIDTH).filter(|&lane| node.planes[0][lane] < f32::INFINITY);
    1 + used.map(|lane| depth(tree, node.children[lane])).max().unwrap_or(0)
}

fn sorted_ids(tree: &Bvh) -> Vec<u32> {
    let mut ids: Vec<u32> =
        tree.ids().iter().flatten().copied().filter(|&id| id != u32::MAX).collect();
    ids.sort_unstable();
    ids
}

/// Asserts that every box contains its spheres; returns the bounds of a child.
fn assert_boxes_hold(set: &SphereSet, tree: &Bvh, child: NodeRef) -> Aabb {
    if child.is_leaf() {
        let ids = tree.ids()[child.index()].iter().filter(|&&id| id != u32::MAX);
        let around = |&id: &u32| Aabb::from_sphere(&set.rounded_particle(id));
        return ids.map(around).fold(Aabb::EMPTY, |a, b| a.union(&b));
    }
    let node = &tree.nodes()[child.index()];
    let mut whole = Aabb::EMPTY;
    for lane in (0..WIDTH).filter(|&lane| node.planes[0][lane] < f32::INFINITY) {
        let inner = assert_boxes_hold(set, tree, node.children[lane]);
        for axis in 0..3 {
            assert!(node.planes[axis][lane] < inner.low[axis], "axis {axis}, {child:?}");
            assert!(node.planes[axis + 3][lane] > inner.high[axis], "axis {axis}, {child:?}");
        }
        whole = whole.union(&inner);
    }
    whole
}

#[test]
fn the_tree_is_the_same_for_any_number_of_threads() {
    let set = set(scattered(100_003));
    for quality in [BuildQuality::Best, BuildQuality::Fast] {
        let (one, shape) = tree_on(1, &set, quality);
        assert!(shape.treelets > 20);
        for threads in [2, 7] {
            let (other, other_shape) = tree_on(threads, &set, quality);
            assert!(one.nodes() == other.nodes());
            assert!(one.ids() == other.ids());
            assert_eq!(one.root, other.root);
            assert_eq!(shape, other_shape);
        }
    }
}

#[test]
fn every_sphere_is_in_one_leaf_and_in_every_box_above() {
    for count in [0, 1, 4, 5, 8, 9, 63, 1000, 20_000] {
        let set = set(scattered(count));
        for quality in [BuildQuality::Best, BuildQuality::Fast] {
            let (tree, _) = tree_on(2, &set, quality);
            assert_eq!(sorted_ids(&tree), (0..count).collect::<Vec<_>>());
            if let Some(root) = tree.root {
                assert_boxes_hold(&set, &tree, root);
            }
        }
    }
}

#[test]
fn the_stack_bound_holds_for_hostile_scenes() {
    let concentric = |i: u32| [0.0, 0.0, 0.0, 1.0 + i as f32];
    let geometric = |i: u32| [0.875f32.powi(i as i32 % 640), 0.0, 0.0, 1e-3 + 1e-9 * i as f32];
    let halving = |i: u32| [0.5f32.powi(i as i32 % 120), 0.0, 0.0, 1e-30 * (1 + i) as f32];
    for scene in [concentric as fn(u32) -> [f32; 4], geometric, halving] {
        let set = set((0..30_000).map(scene).collect());
        for quality in [BuildQuality::Best, BuildQuality::Fast] {
            let (tree, _) = tree_on(2, &set, quality);
            let depth = depth(&tree, tree.root.expect("not empty"));
            assert!(depth <= MAX_DEPTH, "{depth} levels");
            assert_eq!(sorted_ids(&tree).len(), set.particle_count());
        }
    }
}

#[test]
fn a_few_spheres_are_a_list_without_a_tree() {
    for (count, leaves) in
        [(0, 0), (1, 1), (8, 1), (9, 2), (MAX_LIST_SIZE as u32, MAX_LIST_SIZE / 8)]
    {
        let (tree, _) = tree_on(1, &set(scattered(count)), BuildQuality::Best);
        assert_eq!((tree.root, tree.leaves().len()), (None, leaves));
        assert_eq!(sorted_ids(&tree), (0..count).collect::<Vec<_>>());
    }
    assert!(
        tree_on(1, &set(scattered(MAX_LIST_SIZE as u32 + 1)), BuildQuality::Best).0.root.is_some()
    );
}

#[test]
fn the_spheres_of_a_set_come_in_the_order_of_its_curve() {
    let set = set(scattered(10_000));
    assert!(
        (0..set.particle_count() as u32)
            .is_sorted_by_key(|id| set.morton_code(&set.rounded_particle(id)))
    );
}

#[test]
fn a_build_tells_how_far_it_is_and_can_be_cancelled() {
    let set = set(scattered(10_000));
    let cancel = CancelToken::default();
    let last = std::sync::Arc::new(std::sync::Mutex::new(0.0));
    let seen = last.clone();
    let progress = ProgressCallback::new(move |done| *seen.lock().expect("no panic") = done);
    let options = BuildOptions { cancel: cancel.clone(), progress, ..Default::default() };
    build(&set, &options).expect("not cancelled");
    assert_eq!(*last.lock().expect("no panic"), 1.0);
    cancel.cancel();
    assert!(build(&set, &options).is_err());
}
