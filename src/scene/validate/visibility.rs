//! Checks for geometries that no camera sees, and for cameras that see nothing.

use crate::{
    diagnostic::Code,
    scene::{
        animation::frames::Frames,
        format::{
            camera::CameraModel,
            geometry::{GeometryModel, ordinal::Ordinal, walk::Leaf},
            scene::Model,
        },
        framing::Framing,
        problem::{Focus, Problem},
        tables::Tables,
        validate::{enclosed::enclosed, eye::is_glass, found::Found},
        view::ViewSpace,
    },
    text::nearest::quote,
    tracer::shape::plane::Plane,
};

impl Found {
    /// Reports the cameras that see no geometry at any frame.
    pub(super) fn nothing_visible(&mut self, model: &Model, tables: &Tables, framing: &Framing) {
        let when = framing.frames.map_or("", |_| ", in any frame");
        for (name, _) in blind(model, tables, framing) {
            let camera_name = name.map_or_else(String::new, |name| format!(" {}", quote(name)));
            let message = format!("the camera{camera_name} sees none of the geometries{when}");
            let place = Model::path_of_camera(name);
            let problem = Problem::new(Code::NothingVisible, place, Focus::Name, message);
            let help = "the picture is all background: point the camera at a geometry with \
                        `look_at`, or move one in front of it";
            self.push(problem.help(help));
        }
    }

    /// Reports the geometries that no camera can see at any frame.
    pub(super) fn never_visible(&mut self, model: &Model, tables: &Tables, framing: &Framing) {
        let cameras = match (model.all_cameras().count(), framing.frames) {
            (0, _) => return,
            (1, None) => "the camera",
            (_, None) => "every camera",
            (1, Some(_)) => "the camera in every frame",
            (_, Some(_)) => "every camera in every frame",
        };
        let unseen = unseen(model, tables, framing);
        for (at, plane) in hidden_in_planes(model, framing) {
            let message = "this geometry lies in a plane before it in the list, which hides it";
            let problem = Problem::new(Code::NeverVisible, model.path_of(at), Focus::Name, message);
            self.push(
                problem
                    .help("at equal distance the first is visible: move it up in the list, or out of the plane")
                    .label(model.path_of(plane), Focus::Name, "the plane"),
            );
        }
        let is_out = |at: &Ordinal| {
            unseen
                .as_ref()
                .is_some_and(|out| out.binary_search(at).is_ok())
        };
        for (at, cover) in enclosed(model, framing) {
            if is_out(&at) {
                continue;
            }
            let place = cover.place();
            let message = format!("this geometry lies {place}, which hides it from {cameras}");
            let problem = Problem::new(Code::NeverVisible, model.path_of(at), Focus::Name, message);
            self.push(problem.help("remove it, or move it out").label(
                model.path_of(cover.at),
                Focus::Name,
                "this hides it",
            ));
        }
        // An empty table contains nothing to see.
        let is_empty = |at: &Ordinal| tables.count(*at) == 0;
        for at in unseen.into_iter().flatten().filter(|at| !is_empty(at)) {
            if let Some(geometry) = model.geometry(at) {
                let path = model.path_of(at);
                let several = geometry
                    .words()
                    .map(|words| format!("all {} are", words.all));
                let what = several.unwrap_or_else(|| "this geometry is".to_owned());
                let message = format!("{what} outside the view of {cameras}");
                self.push(Problem::new(Code::NeverVisible, path, Focus::Name, message));
            }
        }
    }
}

/// The number of planes in which flat geometries are searched.
const MOST_PLANES: usize = 100;

/// Returns the flat geometries that lie in a plane before them in the list, with that plane. Only where
/// rounding cannot make a difference: both have the same normal, and either the same point or a normal
/// along an axis.
fn hidden_in_planes(model: &Model, framing: &Framing) -> Vec<(Ordinal, Ordinal)> {
    let mut planes: Vec<(Ordinal, Plane)> = Vec::new();
    let mut hidden = Vec::new();
    for leaf in model.leaves().take_while(|_| !framing.is_cancelled()) {
        let is_plane = matches!(leaf.geometry, GeometryModel::Plane(_));
        let is_wanted = match leaf.geometry {
            // What lies in a pane shows through it.
            GeometryModel::Plane(_) => !is_glass(leaf.geometry, model),
            GeometryModel::Disc(_) | GeometryModel::Rectangle(_) | GeometryModel::Triangle(_) => {
                !planes.is_empty()
            }
            _ => false,
        };
        if !is_wanted || framing.moves(model, leaf.at) {
            continue;
        }
        let shape = leaf.shape().filter(|shape| shape.transform().is_none());
        let Some(own) = shape.and_then(|shape| shape.plane().copied()) else {
            continue;
        };
        if is_plane {
            if planes.len() < MOST_PLANES {
                planes.push((leaf.at, own));
            }
        } else if let Some((plane, _)) = planes.iter().find(|(_, plane)| is_same(plane, &own)) {
            hidden.push((leaf.at, *plane));
        }
    }
    hidden
}

/// Returns true if every ray meets both planes at the same t, in every bit.
fn is_same(one: &Plane, other: &Plane) -> bool {
    let n = one.normal();
    let is_along = |axis: usize| {
        let others = (0..3).filter(|other| *other != axis);
        others.map(|other| n[other]).all(|x| x == 0.0) && one.point()[axis] == other.point()[axis]
    };
    (n == other.normal() || n == -other.normal())
        && (one.point() == other.point() || (0..3).any(is_along))
}

/// The maximum number of tests of a geometry against a camera at a frame.
const MOST_WORK: usize = 10_000_000;

/// Returns the geometries that no camera can see at any frame, in ascending order; `None` if a camera is
/// invalid, or if the search would take too long.
fn unseen(model: &Model, tables: &Tables, framing: &Framing) -> Option<Vec<Ordinal>> {
    let frames = framing.frames;
    if let Some(frames) = frames {
        let more: usize = tables.contents().map(|(_, content)| content.count()).sum();
        let work = (model.leaves().count() + more) * model.all_cameras().count();
        let work = work + frames.targets().count();
        if work.saturating_mul(frames.count() as usize) > MOST_WORK {
            return None;
        }
    }
    // The rows of a table may change their size with its `radius`, and a part its place.
    let stays = |at: &Ordinal| !(tables.has(*at) && framing.moves(model, *at));
    let all = model.leaves().map(|leaf| leaf.at);
    // Without frames, all are looked at once.
    let mut left = Some(match frames {
        None => Vec::new(),
        Some(_) => all.filter(stays).collect(),
    });
    Frames::each(frames, model, |number, cameras, world| {
        let views = cameras.all_cameras().map(|(_, camera)| {
            let size = cameras.sides();
            ViewSpace::of(&framing.build(camera, size, number).ok()?, size)
        });
        let views = views.collect::<Option<Vec<_>>>();
        left = left.take().zip(views).map(|(left, views)| {
            let mut ordered = left.iter().peekable();
            let is_unseen = |leaf: &Leaf| {
                let is_left = frames.is_none() || ordered.next_if_eq(&&leaf.at).is_some();
                is_left
                    && !framing.is_cancelled()
                    && views.iter().all(|view| view.certainly_misses(leaf, tables))
            };
            let unseen = world.leaves().filter(is_unseen);
            unseen.map(|leaf| leaf.at).collect()
        });
        left.as_ref().is_some_and(|left| !left.is_empty()) && !framing.is_cancelled()
    });
    left
}

/// A camera with its name, if it has one.
type Named<'a> = (Option<&'a str>, &'a CameraModel);

/// Returns the cameras that certainly see no geometry at any frame; none if the search would take
/// too long.
fn blind<'a>(model: &'a Model, tables: &Tables, framing: &Framing) -> Vec<Named<'a>> {
    let frames = framing.frames;
    // The rows of a table may change their size with its `radius`, and a part its place.
    if tables.contents().any(|(at, _)| framing.moves(model, at)) {
        return Vec::new();
    }
    let mut blind: Vec<(usize, Named)> = model.all_cameras().enumerate().collect();
    let mut left = MOST_WORK;
    Frames::each(frames, model, |_, shown, world| {
        left = left.saturating_sub(frames.map_or(0, |frames| frames.targets().count()));
        if left == 0 || frames.is_some() && framing.is_cancelled() {
            blind.clear();
        }
        let cameras: Vec<_> = shown.all_cameras().map(|(_, camera)| camera).collect();
        blind.retain(|(index, _)| {
            let camera = cameras.get(*index);
            camera.is_some_and(|camera| is_blind(camera, shown, world, tables, &mut left))
        });
        !blind.is_empty()
    });
    blind.into_iter().map(|(_, camera)| camera).collect()
}

/// Returns true if a camera certainly sees no geometry of a world; `left` is the number of tests
/// still allowed.
fn is_blind(
    camera: &CameraModel,
    scene: &Model,
    world: &Model,
    tables: &Tables,
    left: &mut usize,
) -> bool {
    // One that frames the geometries has no place of its own, and sees them.
    let view = camera.build().ok();
    let Some(view) = view.and_then(|camera| ViewSpace::of(&camera, scene.sides())) else {
        return false;
    };
    world.leaves().all(|leaf| {
        let work = tables.count(leaf.at).max(1);
        let is_affordable = *left >= work;
        *left = left.saturating_sub(work);
        is_affordable && view.certainly_misses(&leaf, tables)
    })
}
