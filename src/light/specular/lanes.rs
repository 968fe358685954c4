//! Roots of the equations of many pairs of points and one ball, found in lanes.
//!
//! First, every lane finds its fold and the ends of its branches. Then the searches that have a
//! root are gathered from all lanes, since most targets have none, and run together. Lanes call the
//! functions of the scalar code, and so find the same bits.

use std::marker::PhantomData;

use crate::geometry::Sphere;
use crate::math::{DVec3, Isa, LANES, Lanes, Lanes3, SimdKernel};

use super::connection::Connection;
use super::deflection::{MAX_STATIONARY_STEPS, StationaryPoint};
use super::equation::{Equation, MAX_BRANCHES, MAX_ROOTS, connection_of};
use super::path_kind::{SpecularPath, all_roots};
use super::phase::Phase;
use super::plane::{Target, Triangle, are_outside};
use super::reflection::Reflection;
use super::root::{Branch, MAX_STEPS, Search, branches_of, guess, is_between};
use super::through::Through;

/// No root.
const NONE: f64 = -1.0;

/// The points to connect: x and, for each, y or the direction to it.
#[derive(Default)]
pub struct EndLanes {
    /// x.
    pub x: Lanes3,
    /// y, or the unit direction to it.
    pub y: Lanes3,
    /// True if `y` is a direction.
    pub is_direction: bool,
    /// True in the lanes that are used.
    pub is_used: Lanes<bool>,
}

/// The roots of one kind in every lane.
pub struct RootLanes([Lanes<f64>; MAX_ROOTS]);

/// Finds roots. Keeps its memory.
#[derive(Default)]
pub struct RootFinder {
    curves: CurveLanes,
    searches: SearchLanes,
}

/// `psi` in every lane.
#[derive(Default)]
struct CurveLanes {
    ratios: [Lanes<f64>; 2],
    half_angle: PhaseLanes,
    /// Half of `psi` at `w = 1`.
    end: PhaseLanes,
    /// `w` at the fold, 0 without one.
    fold: Lanes<f64>,
    at_fold: PhaseLanes,
    /// True if there is anything to find.
    is_used: Lanes<bool>,
}

/// Searches in lanes, of which each belongs to one target and branch of any lane.
#[derive(Default)]
struct SearchLanes {
    count: usize,
    /// The lane and the number of the root.
    owners: [(usize, usize); LANES],
    ratios: [Lanes<f64>; 2],
    ends: [Lanes<f64>; 2],
    /// Half of the difference of `psi` and the target at the ends.
    differences: [PhaseLanes; 2],
    half_target: PhaseLanes,
    w: Lanes<f64>,
}

#[derive(Default)]
struct PhaseLanes {
    re: Lanes<f64>,
    im: Lanes<f64>,
}

impl Default for RootLanes {
    fn default() -> Self {
        Self([Lanes::splat(NONE); MAX_ROOTS])
    }
}

impl RootLanes {
    /// Hands each path of a lane to `found`, in the order of [`SpecularPath::connect_each`]. All
    /// else must be as it was when the roots were found.
    #[inline]
    pub fn connect_each(
        &self,
        lane: usize,
        kind: SpecularPath,
        (ball, ior): (&Sphere, f64),
        ends: (DVec3, Target),
        found: impl FnMut(Connection),
    ) {
        let of_root = |root| match kind {
            SpecularPath::Through => connection_of::<Through<0>>(ball, ior, ends, root),
            SpecularPath::ThroughReflected => connection_of::<Through<1>>(ball, ior, ends, root),
            _ => connection_of::<Reflection>(ball, ior, ends, root),
        };
        self.of_lane(lane).map(of_root).for_each(all_roots(found));
    }

    /// The roots of a lane: the number of the target, and `w`.
    fn of_lane(&self, lane: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let root = move |(slot, w): (usize, &Lanes<f64>)| (slot / MAX_BRANCHES, w.0[lane]);
        self.0.iter().enumerate().map(root).filter(|(_, w)| *w >= 0.0)
    }
}

impl RootFinder {
    /// Finds all roots of a kind over a ball of index `ior`. Kinds across one boundary have none
    /// here.
    pub fn find(
        &mut self,
        isa: Isa,
        kind: SpecularPath,
        (ball, ior): (&Sphere, f64),
        ends: &EndLanes,
        roots: &mut RootLanes,
    ) {
        match kind {
            SpecularPath::Reflection => self.solve::<Reflection>(isa, ball, ior, ends, roots),
            SpecularPath::Through => self.solve::<Through<0>>(isa, ball, ior, ends, roots),
            SpecularPath::ThroughReflected => self.solve::<Through<1>>(isa, ball, ior, ends, roots),
            SpecularPath::Outward | SpecularPath::Inward => {}
        }
    }

    fn solve<E: Equation>(
        &mut self,
        isa: Isa,
        ball: &Sphere,
        ior: f64,
        ends: &EndLanes,
        roots: &mut RootLanes,
    ) {
        let Self { curves, searches } = self;
        isa.run(FindFolds::<E> { curves, ends, ball: *ball, ior, equation: PhantomData });
        roots.0.iter_mut().for_each(|slot| *slot = Lanes::splat(NONE));
        searches.count = 0;
        for lane in (0..LANES).filter(|&lane| curves.is_used.0[lane]) {
            let branches = curves.branches(lane);
            let targets = E::targets(curves.half_angle.get(lane), &branches);
            for (target, half) in targets.into_iter().enumerate() {
                let Some(half_target) = half else { continue };
                for (at, branch) in branches.iter().enumerate() {
                    let Some(branch) = branch else { continue };
                    let differences = branch.halves.map(|half| half * half_target);
                    if !is_between(differences) {
                        continue;
                    }
                    let ratios = [0, 1].map(|i: usize| curves.ratios[i].0[lane]);
                    let slot = target * MAX_BRANCHES + at;
                    searches.push((lane, slot), ratios, branch.ends, differences, half_target);
                    if searches.count == LANES {
                        searches.run::<E>(isa, ior, roots);
                    }
                }
            }
        }
        if searches.count > 0 {
            searches.run::<E>(isa, ior, roots);
        }
    }
}

impl CurveLanes {
    fn branches(&self, lane: usize) -> [Option<Branch>; MAX_BRANCHES] {
        let fold = self.fold.0[lane];
        let fold = (fold > 0.0 && fold < 1.0).then(|| (fold, self.at_fold.get(lane)));
        branches_of(self.end.get(lane), fold)
    }
}

impl SearchLanes {
    fn push(
        &mut self,
        owner: (usize, usize),
        ratios: [f64; 2],
        ends: [f64; 2],
        differences: [Phase; 2],
        half_target: Phase,
    ) {
        let lane = self.count;
        self.owners[lane] = owner;
        for i in 0..2 {
            self.ratios[i].0[lane] = ratios[i];
            self.ends[i].0[lane] = ends[i];
            self.differences[i].set(lane, differences[i]);
        }
        self.half_target.set(lane, half_target);
        self.count += 1;
    }

    /// Runs all searches and stores what they find.
    fn run<E: Equation>(&mut self, isa: Isa, ior: f64, roots: &mut RootLanes) {
        isa.run(RunSearches::<E> { searches: self, ior, equation: PhantomData });
        for (found, &(lane, slot)) in self.owners[..self.count].iter().enumerate() {
            roots.0[slot].0[lane] = self.w.0[found];
        }
        self.count = 0;
    }
}

impl PhaseLanes {
    #[inline(always)]
    fn get(&self, lane: usize) -> Phase {
        Phase { re: self.re.0[lane], im: self.im.0[lane] }
    }

    #[inline(always)]
    fn set(&mut self, lane: usize, phase: Phase) {
        (self.re.0[lane], self.im.0[lane]) = (phase.re, phase.im);
    }
}

/// Finds the folds, and `psi` there and at the end.
struct FindFolds<'a, E> {
    curves: &'a mut CurveLanes,
    ends: &'a EndLanes,
    ball: Sphere,
    ior: f64,
    equation: PhantomData<E>,
}

impl<E: Equation> SimdKernel for FindFolds<'_, E> {
    #[inline(always)]
    fn run(self) {
        let Self { curves, ends, ball, ior, .. } = self;
        for lane in 0..LANES {
            let (x, y) = (ends.x.get(lane), ends.y.get(lane));
            let y = if ends.is_direction { Target::Direction(y) } else { Target::Point(y) };
            let triangle = Triangle::new(&ball, x, y);
            let ratios = E::ratios(triangle.distances, ior);
            (curves.ratios[0].0[lane], curves.ratios[1].0[lane]) = (ratios[0], ratios[1]);
            curves.half_angle.set(lane, E::half_angle(triangle.cos_theta, triangle.sin_theta));
            curves.is_used.0[lane] = ends.is_used.0[lane] & are_outside(triangle.distances);
        }
        let CurveLanes { ratios, end, fold, at_fold, is_used, .. } = curves;
        let deflection = |lane: usize| E::deflection([ratios[0].0[lane], ratios[1].0[lane]], ior);
        let [mut u, mut largest] = [Lanes::splat(0.0); 2];
        let mut is_found = Lanes::splat(true);
        for lane in 0..LANES {
            end.set(lane, deflection(lane).eval(1.0).half);
            let start = deflection(lane).start_stationary().filter(|_| is_used.0[lane]);
            let point = start.unwrap_or(StationaryPoint::NONE);
            (u.0[lane], largest.0[lane]) = (point.u, point.largest);
            is_found.0[lane] = point.is_found;
        }
        if is_found.0.iter().all(|&is_found| is_found) {
            *fold = Lanes::splat(0.0);
            return;
        }
        for _ in 0..MAX_STATIONARY_STEPS {
            for lane in 0..LANES {
                let is_over = is_found.0[lane];
                let mut point =
                    StationaryPoint { u: u.0[lane], largest: largest.0[lane], is_found: false };
                deflection(lane).step_to_stationary(&mut point);
                u.0[lane] = if is_over { u.0[lane] } else { point.u };
                is_found.0[lane] = is_over | point.is_found;
            }
            if is_found.0.iter().all(|&is_found| is_found) {
                break;
            }
        }
        for lane in 0..LANES {
            let point = StationaryPoint { u: u.0[lane], ..StationaryPoint::NONE };
            fold.0[lane] = point.w();
            at_fold.set(lane, deflection(lane).eval(point.w()).half);
        }
    }
}

/// Runs searches.
struct RunSearches<'a, E> {
    searches: &'a mut SearchLanes,
    ior: f64,
    equation: PhantomData<E>,
}

impl<E: Equation> SimdKernel for RunSearches<'_, E> {
    #[inline(always)]
    fn run(self) {
        let Self { searches, ior, .. } = self;
        let SearchLanes { count, ratios, ends, differences, half_target, w, .. } = searches;
        let (mut low, mut high, mut is_found) = (ends[0], ends[1], Lanes::splat(false));
        for lane in 0..LANES {
            let halves = [differences[0].get(lane), differences[1].get(lane)];
            w.0[lane] = guess([ends[0].0[lane], ends[1].0[lane]], halves);
        }
        for step in 0..MAX_STEPS {
            for lane in 0..LANES {
                let mut search = Search {
                    ends: [ends[0].0[lane], ends[1].0[lane]],
                    half_target: half_target.get(lane),
                    is_rising: differences[0].im.0[lane] < 0.0,
                    low: low.0[lane],
                    high: high.0[lane],
                    w: w.0[lane],
                    is_found: false,
                };
                let ratios = [ratios[0].0[lane], ratios[1].0[lane]];
                E::deflection(ratios, ior).advance(&mut search, step);
                let is_over = is_found.0[lane];
                low.0[lane] = if is_over { low.0[lane] } else { search.low };
                high.0[lane] = if is_over { high.0[lane] } else { search.high };
                w.0[lane] = if is_over { w.0[lane] } else { search.w };
                is_found.0[lane] = is_over | search.is_found;
            }
            if is_found.0[..*count].iter().all(|&is_found| is_found) {
                break;
            }
        }
    }
}
