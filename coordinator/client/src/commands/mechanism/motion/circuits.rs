//! Circuits: connected pieces of the real positions of each mode, and of all modes together.

use super::reduced::Reduction;
use super::walks::{RealPoint, Walker};
use super::{Work, prepared};
use crate::error::ClientError;
use crate::mechanism::motion_answer::RealPositions;
use crate::sets::{Known, KnownSet};
use cognate_kinematics::compile::motion::DegreeIn;
use cognate_solutions::disjoint_sets::DisjointSets;
use cognate_solutions::witness::question::{CurveWish, GivenPoint};
use cognate_solutions::witness::{ComponentId, Question};
use cognate_summary::question_answer::{CurveBlock, CurveCountsBlock, QuestionAnswer};
use num_complex::Complex64;
use serde_json::json;

/// A common position of two modes is a vertex of both curves within this, relative to its size.
const SAME: f64 = 1e-5;

/// Real curves of loops in more cosines and sines than these take hours: their equations are of degree 3, and many. They are
/// followed in fewer unknowns.
const MOST_JOINT_UNKNOWNS: usize = 10;
/// The error of a witness point, relative to its size.
const WITNESS: f64 = 1e-12;

/// A connected part of a real curve.
struct Piece {
    /// Points where arcs begin and end, and an arc's own where it has no ends.
    vertices: Vec<Vec<Complex64>>,
    /// Whether it is more than a point.
    moves: bool,
}

impl Work<'_> {
    /// Follows the real curves.
    pub(super) async fn find_circuits(&mut self) -> Result<(), ClientError> {
        let is_curve = |place: &usize| self.answer.modes[*place].dimension == 1;
        let curves: Vec<usize> = (0..self.components.len()).filter(is_curve).collect();
        let mut pieces: Vec<Option<Vec<Piece>>> = Vec::new();
        pieces.resize_with(self.components.len(), || None);
        let is_long = self.asked.motion.degree_in == DegreeIn::Joints
            && self.asked.system.variables.len() > MOST_JOINT_UNKNOWNS;
        let mut reduction = None;
        if is_long {
            reduction = self.reduction(&curves);
            if reduction.is_none() {
                self.doubt(
                    "not in this version: circuits of this loop with more than five joints; the other fields are those \
                     without --real",
                );
                return Ok(());
            }
        }
        if let Some(reduction) = &reduction {
            self.follow_images(reduction, &curves, &mut pieces).await?;
        } else if !curves.is_empty() {
            let chosen: Vec<_> = curves.iter().map(|place| self.components[*place]).collect();
            let set = self.only(&chosen);
            let places: Vec<_> = chosen.iter().copied().zip(curves).collect();
            self.follow_curves(&set, &places, &mut pieces).await?;
        }
        for place in 0..self.components.len() {
            if self.answer.modes[place].dimension > 1 {
                pieces[place] = self.pieces_with_freedoms(place).await?;
            }
        }
        let seen = |point: &[Complex64]| match &reduction {
            Some(reduction) => reduction.image(point),
            None => point.to_vec(),
        };
        self.answer.circuits = self.all_together(&pieces, seen);
        if self.answer.circuits.is_none() && self.answer.doubts.is_empty() {
            self.doubt("on which circuits modes meet is not clear");
        }
        Ok(())
    }

    /// Equations of a long loop in fewer unknowns, which have the same circuits; `None` where there are none, or a mode has
    /// several freedoms.
    fn reduction(&self, curves: &[usize]) -> Option<Reduction> {
        if curves.len() < self.components.len() {
            return None;
        }
        let components = self.set.components.iter();
        let components = components.filter(|component| self.components.contains(&component.set.id));
        let points: Vec<&Vec<Complex64>> = components
            .map(|component| &component.set.points[0])
            .collect();
        Reduction::of(&self.asked.system, &points, self.wishes.seed)
    }

    /// The real curves of some components, each of which is a mode or its image.
    async fn follow_curves(
        &mut self,
        set: &KnownSet,
        places: &[(ComponentId, usize)],
        pieces: &mut [Option<Vec<Piece>>],
    ) -> Result<(), ClientError> {
        let wish = CurveWish {
            samples: 1,
            ..CurveWish::default()
        };
        let question = Question::RealCurve(wish);
        let Some(QuestionAnswer::RealCurve(answer)) = self.ask(set, question).await? else {
            return Ok(());
        };
        for (counts, curve) in answer.components.iter().zip(&answer.curves) {
            let place = places.iter().find(|(id, _)| id.to_string() == counts.id);
            if let Some((_, place)) = place {
                self.learn(*place, counts, curve, pieces);
            }
        }
        Ok(())
    }

    /// The real curves of the images of all modes in fewer unknowns.
    async fn follow_images(
        &mut self,
        reduction: &Reduction,
        curves: &[usize],
        pieces: &mut [Option<Vec<Piece>>],
    ) -> Result<(), ClientError> {
        let prepared = prepared(
            (self.wishes.seed, self.wishes.preset),
            &self.set.name,
            &reduction.system,
            DegreeIn::Joints,
        );
        let (_, mut images) = match self.jobs.decompose(prepared, None).await {
            Ok(decomposed) => decomposed,
            Err(ClientError::GaveUp(message) | ClientError::Refused(message)) => {
                self.doubt(message);
                return Ok(());
            }
            Err(error) => return Err(error),
        };
        let is_simple = |component: &Known| {
            component.set.dimension() == 1
                && component.set.settled()
                && component.set.multiplicity.scheme == Some(1)
        };
        images.components.retain(is_simple);
        let mut places: Vec<(ComponentId, usize)> = Vec::new();
        for place in curves {
            match self.image_of(*place, reduction, &images).await? {
                Some(image) if places.iter().all(|(other, _)| *other != image) => {
                    places.push((image, *place));
                }
                _ => {
                    let id = self.answer.modes[*place].id.clone();
                    self.doubt(format!(
                        "the circuits of mode {id} are not clear: its image in fewer unknowns is not"
                    ));
                    return Ok(());
                }
            }
        }
        let chosen = |component: &Known| places.iter().any(|(image, _)| *image == component.set.id);
        images.components.retain(chosen);
        self.follow_curves(&images, &places, pieces).await?;
        for (_, place) in &places {
            let vertices = pieces[*place].iter().flatten();
            let mut vertices = vertices.flat_map(|piece| &piece.vertices);
            if vertices.any(|vertex| !reduction.determines(vertex)) {
                let id = self.answer.modes[*place].id.clone();
                self.answer.modes[*place].real = None;
                pieces[*place] = None;
                self.doubt(format!(
                    "the circuits of mode {id} are not clear: joints are left open where others have certain values"
                ));
            }
        }
        Ok(())
    }

    /// The component that is the image of a mode; `None` where that is not clear.
    async fn image_of(
        &mut self,
        place: usize,
        reduction: &Reduction,
        images: &KnownSet,
    ) -> Result<Option<ComponentId>, ClientError> {
        let id = self.components[place];
        let mode = self
            .set
            .components
            .iter()
            .find(|component| component.set.id == id);
        let points: Vec<GivenPoint> = mode
            .iter()
            .map(|component| GivenPoint {
                values: reduction.image(&component.set.points[0]),
                accuracy: WITNESS,
            })
            .collect();
        if images.components.is_empty() {
            return Ok(None);
        }
        let question = Question::Member { points };
        let Some(QuestionAnswer::Member(answer)) = self.ask(images, question).await? else {
            return Ok(None);
        };
        let settled = answer.points.first().filter(|p| p.unsettled.is_empty());
        Ok(match settled.map(|point| point.on.as_slice()) {
            Some([only]) => only.parse().ok(),
            _ => None,
        })
    }

    /// Pieces of a mode with several freedoms: as many as lengths tell; else none, or one where walks lead from one real
    /// point to all others.
    async fn pieces_with_freedoms(
        &mut self,
        place: usize,
    ) -> Result<Option<Vec<Piece>>, ClientError> {
        let (id, dimension) = (
            self.answer.modes[place].id.clone(),
            self.answer.modes[place].dimension,
        );
        if let ([_], Some(circuits)) = (&self.components[..], self.asked.connected_parts) {
            return Ok(Some(self.with_circuits(place, circuits)));
        }
        let set = self.only(&[self.components[place]]);
        let doubts = self.answer.doubts.len();
        let answer = self.ask(&set, Question::RealPoints).await?;
        let Some(QuestionAnswer::RealPoints(answer)) = answer else {
            return Ok(None);
        };
        let points = answer.points.into_iter().map(|p| RealPoint {
            values: p.point,
            is_regular: p.regular,
        });
        let points: Vec<RealPoint> = points.collect();
        let mut walker = Walker::new(self.asked, dimension, self.wishes.seed);
        let circuits = match points.is_empty() {
            _ if self.answer.doubts.len() > doubts => None,
            true => Some(0),
            false => walker.are_joined(&points).map(|_| 1),
        };
        let Some(circuits) = circuits else {
            self.doubt(format!(
                "mode {id} has {dimension} freedoms: how many circuits its real positions form is not clear"
            ));
            return Ok(None);
        };
        Ok(Some(self.with_circuits(place, circuits)))
    }

    /// Notes the circuits of a mode with several freedoms; they have no vertices.
    fn with_circuits(&mut self, place: usize, circuits: u64) -> Vec<Piece> {
        self.answer.modes[place].real = Some(RealPositions {
            circuits,
            counts: json!({"pieces": circuits}),
        });
        let piece = |_| Piece {
            vertices: Vec::new(),
            moves: true,
        };
        (0..circuits).map(piece).collect()
    }

    /// Reads what the real part of one mode consists of.
    fn learn(
        &mut self,
        place: usize,
        counts: &CurveCountsBlock,
        curve: &CurveBlock,
        pieces: &mut [Option<Vec<Piece>>],
    ) {
        if !counts.settled {
            return;
        }
        let parts = parts_of(curve);
        let circuits = parts.iter().filter(|piece| piece.moves).count() as u64;
        if circuits + counts.isolated_points != counts.connected_components {
            let id = self.answer.modes[place].id.clone();
            self.doubt(format!("the circuits of mode {id} do not add up"));
            return;
        }
        self.answer.modes[place].real = Some(RealPositions {
            circuits,
            counts: json!({
                "loops": counts.closed_loops, "arcs": counts.unbounded_arcs,
                "isolated_points": counts.isolated_points,
                "singular_points": counts.singular_points,
            }),
        });
        pieces[place] = Some(parts);
    }

    /// Pieces of all real positions together: those that meet are one. `seen`: a position in the unknowns of the pieces.
    fn all_together(
        &self,
        pieces: &[Option<Vec<Piece>>],
        seen: impl Fn(&[Complex64]) -> Vec<Complex64>,
    ) -> Option<u64> {
        let pieces: Option<Vec<&Vec<Piece>>> = pieces.iter().map(Option::as_ref).collect();
        let pieces = pieces?;
        let begins: Vec<usize> = pieces
            .iter()
            .scan(0, |sum, list| {
                let begin = *sum;
                *sum += list.len();
                Some(begin)
            })
            .collect();
        let count = pieces.iter().map(|list| list.len()).sum();
        let mut sets = DisjointSets::new(count);
        for meeting in &self.answer.meetings {
            let places = meeting.modes.each_ref().map(|id| {
                let modes = &self.answer.modes;
                modes.iter().position(|mode| mode.id == *id)
            });
            let [first, second] = [places[0]?, places[1]?];
            for point in meeting.points.as_ref()? {
                if !point.is_real? {
                    continue;
                }
                let on = [first, second].map(|mode| {
                    let at = piece_at(pieces[mode], &seen(&point.solution));
                    at.map(|piece| begins[mode] + piece)
                });
                sets.join(on[0]?, on[1]?);
            }
        }
        let moving = pieces.iter().flat_map(|list| list.iter());
        let moving = moving.enumerate().filter(|(_, piece)| piece.moves);
        let mut roots: Vec<usize> = moving.map(|(place, _)| sets.root(place)).collect();
        roots.sort_unstable();
        roots.dedup();
        Some(roots.len() as u64)
    }
}

/// The piece of which a point is a vertex.
fn piece_at(pieces: &[Piece], point: &[Complex64]) -> Option<usize> {
    let size = point.iter().map(|z| z.norm_sqr()).sum::<f64>().sqrt();
    let is_near = |vertex: &Vec<Complex64>| {
        let pairs = vertex.iter().zip(point);
        let gap = pairs.map(|(a, b)| (a - b).norm_sqr()).sum::<f64>().sqrt();
        gap <= SAME * size.max(1.0)
    };
    let at = |piece: &Piece| piece.vertices.iter().any(is_near);
    match pieces {
        [lone] if lone.moves => Some(0),
        _ => pieces.iter().position(at),
    }
}

/// Connected parts of a curve.
fn parts_of(curve: &CurveBlock) -> Vec<Piece> {
    let (vertices, edges) = (&curve.vertices, &curve.edges);
    let mut sets = DisjointSets::new(vertices.len() + edges.len());
    let mut has_arcs = vec![false; vertices.len() + edges.len()];
    for (k, edge) in edges.iter().enumerate() {
        has_arcs[vertices.len() + k] = true;
        for end in edge.ends.into_iter().flatten() {
            sets.join(end, vertices.len() + k);
        }
    }
    let mut roots = Vec::new();
    let mut pieces: Vec<Piece> = Vec::new();
    for place in 0..vertices.len() + edges.len() {
        let root = sets.root(place);
        let piece = match roots.iter().position(|other| *other == root) {
            Some(piece) => piece,
            None => {
                roots.push(root);
                pieces.push(Piece {
                    vertices: Vec::new(),
                    moves: false,
                });
                pieces.len() - 1
            }
        };
        pieces[piece].moves |= has_arcs[place];
        if let Some(vertex) = vertices.get(place) {
            pieces[piece].vertices.push(vertex.point.clone());
        }
    }
    pieces
}
