//! What is attached to a shaft, checked: disks, bearings, supports, loads, probes.

use crate::case::{ActsOn, Hub};
use crate::model::{BearingTable, Coefficients};
use crate::section::Surface;

impl Hub {
    /// What the disk's inertia acts on.
    pub fn acts_on(self) -> ActsOn {
        match self {
            Self::Rigid | Self::Soft => ActsOn::Axis,
            Self::Bore => ActsOn::Bore,
            Self::Rim => ActsOn::Rim,
        }
    }

    /// Name in case files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Rigid => "rigid",
            Self::Soft => "soft",
            Self::Bore => "bore",
            Self::Rim => "rim",
        }
    }
}

/// A rigid disk at a node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Disk {
    /// Node it sits on.
    pub node: usize,
    /// Mass of the disk, kg.
    pub mass: f64,
    /// Moment of inertia about the axis of the shaft, kg m^2.
    pub polar_inertia: f64,
    /// kg m^2, at least half the polar inertia.
    pub diametral_inertia: f64,
    /// Offset of the centre of mass along the section's y and z, m.
    pub offset: [f64; 2],
    /// How it holds the shaft.
    pub hub: Hub,
}

impl Disk {
    /// `Id - Jp/2`, what the thickness adds to the diametral inertia of a thin disk, kg m^2; zero within rounding.
    pub fn thickness_inertia(&self) -> f64 {
        let excess = self.diametral_inertia - self.polar_inertia / 2.0;
        if excess > 1e-12 * self.diametral_inertia { excess } else { 0.0 }
    }
}

impl ActsOn {
    /// The line it is, if any.
    pub fn surface(self) -> Option<Surface> {
        match self {
            Self::Section | Self::Axis => None,
            Self::Bore => Some(Surface::Bore),
            Self::Rim => Some(Surface::Rim),
        }
    }
}

/// What of a section a bearing resists.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Resists {
    /// Mean displacement along y and z, m.
    Lateral,
    /// Mean turn about y and z, rad.
    Tilt,
    /// Mean displacement along x, m; the first entry of a law.
    Axial,
    /// Mean turn about x, rad; the first entry of a law.
    Torsion,
}

/// What the springs of a bearing are fastened to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Between {
    /// The shaft and the ground.
    ShaftAndGround,
    /// The shaft and a housing, by its index in [`Model::housings`](super::Model::housings).
    ShaftAndHousing(usize),
    /// A housing and the ground.
    HousingAndGround(usize),
    /// Both sides of a coupling: the displacements of the left one less those of the right one.
    Halves,
}

/// Linear springs, dampers and added mass at a node, in the fixed directions y and z:
/// `f = -(K u + C u' + M u'')` for what is resisted, u.
#[derive(Debug, Clone, PartialEq)]
pub struct Bearing {
    /// Node it holds; of a housing's own springs the node at which the housing stands.
    pub node: usize,
    /// What they are fastened to.
    pub between: Between,
    /// What they resist.
    pub resists: Resists,
    /// `[[kyy, kyz], [kzy, kzz]]`, N/m (N m/rad for turns).
    pub stiffness: [[f64; 2]; 2],
    /// `[[cyy, cyz], [czy, czz]]`, N s/m (N m s/rad for turns).
    pub damping: [[f64; 2]; 2],
    /// `[[myy, myz], [myz, mzz]]`, kg, symmetric and not negative.
    pub mass: [[f64; 2]; 2],
    /// The same over speed and whirl frequency, where they change; the values above are then those at standstill.
    pub table: Option<BearingTable>,
    /// Where along y and z its springs are without force, m from the undeformed axis.
    pub offset: [f64; 2],
    /// What it holds.
    pub acts_on: ActsOn,
    /// True where it carries no static load.
    pub seal: bool,
    /// JSON path, for reports.
    pub path: String,
}

impl Bearing {
    /// True when what it resists has two directions across the axis, which turn with a turning frame.
    pub fn is_across(&self) -> bool {
        matches!(self.resists, Resists::Lateral | Resists::Tilt)
    }

    /// True for springs of bearings and seals, not of housings and couplings.
    pub fn holds_shaft(&self) -> bool {
        !matches!(self.between, Between::HousingAndGround(_) | Between::Halves)
    }

    /// True when the stiffness is not symmetric.
    pub fn couples(&self) -> bool {
        self.stiffness[0][1] != self.stiffness[1][0]
    }

    /// Its law at standstill.
    pub fn at_rest(&self) -> Coefficients {
        Coefficients { stiffness: self.stiffness, damping: self.damping, mass: self.mass }
    }

    /// True when it damps.
    pub fn damps(&self) -> bool {
        self.damping != [[0.0; 2]; 2]
    }
}

/// A body without extent between bearings and the ground, which moves along y and z. Its springs and its mass are those of a
/// [`Bearing`] between it and the ground.
#[derive(Debug, Clone, PartialEq)]
pub struct Housing {
    /// Node among whose coordinates its displacement stands.
    pub node: usize,
    /// JSON path, for reports.
    pub path: String,
}

/// How an end section of a kinematic support behaves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SectionHold {
    /// Stays plane; may expand in its plane, in which this is held.
    Plane(ActsOn),
    /// Keeps its shape entirely.
    Rigid,
}

/// Kinematic supports, see docs/theory/supports.md#kinds.
#[derive(Debug, Clone, PartialEq)]
pub enum SupportKind {
    /// No displacement, no tilt, no rotation.
    Clamped(SectionHold),
    /// As clamped, spinning: its mean rotation follows the drive, or is free when not driven.
    Revolute {
        /// How the section is held.
        hold: SectionHold,
        /// Rotation prescribed by the drive.
        driven: bool,
    },
    /// As revolute, free along the axis.
    Cylindrical {
        /// How the section is held.
        hold: SectionHold,
        /// Rotation prescribed by the drive.
        driven: bool,
    },
    /// Mean displacement held in x, y and z; tilt free.
    Pinned(ActsOn),
    /// Mean displacement held in y and z; tilt free.
    Roller(ActsOn),
    /// Nothing held but the mean rotation of the section, which the drive prescribes.
    Turned,
    /// Exactly these components: `(vector index, component)`, in the order of the element's vectors.
    Fix(Vec<(usize, usize)>),
}

/// A kinematic support at a node.
#[derive(Debug, Clone, PartialEq)]
pub struct Support {
    /// Node it holds.
    pub node: usize,
    /// What it holds.
    pub kind: SupportKind,
    /// JSON path, for messages.
    pub path: String,
}

/// Where displacements are read.
#[derive(Debug, Clone, PartialEq)]
pub struct Probe {
    /// Name in reports.
    pub name: String,
    /// Position along the shaft, m.
    pub x: f64,
    /// Points `[y, z]` in the section, m.
    pub points: Vec<[f64; 2]>,
}

/// What a load at a node does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LoadKind {
    /// Force `[x, y, z]`, N.
    Force([f64; 3]),
    /// Moment about `[x, y, z]`, N m.
    Moment([f64; 3]),
}

/// What happens to a load when the shaft moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reading {
    /// Axes fixed in space: a force on the section where it is, a moment on its rotation, a traction per undeformed area.
    FixedInSpace,
    /// Axes that turn with the section; pressure on the surface as it is.
    Following,
    /// The tractions that the load is on the undeformed shaft, in size and direction, whatever the motion.
    Dead,
}

/// A load at a node.
#[derive(Debug, Clone, PartialEq)]
pub struct Load {
    /// Node it acts on.
    pub node: usize,
    /// Force or moment.
    pub kind: LoadKind,
    /// What it takes hold of.
    pub acts_on: ActsOn,
    /// How it moves.
    pub reading: Reading,
    /// JSON path, for messages and reports.
    pub path: String,
}

impl Load {
    /// True when it does not change as seen from the turning shaft: it follows, or acts along or about x alone.
    pub fn is_constant_in_turning_frame(&self) -> bool {
        let (axial, turns) = match self.kind {
            LoadKind::Force([_, y, z]) => ([y, z] == [0.0; 2], true),
            LoadKind::Moment([_, y, z]) => ([y, z] == [0.0; 2], self.reading != Reading::Dead),
        };
        self.reading == Reading::Following || (axial && turns)
    }
}

/// Force per area of a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SurfaceLoad {
    /// Force per undeformed area `[x, y, z]`, Pa.
    Traction([f64; 3]),
    /// Against the surface, Pa.
    Pressure(f64),
}

/// A load on a part of the lateral surface of the whole shaft, of its bore where it has one.
#[derive(Debug, Clone, PartialEq)]
pub struct Traction {
    /// Part of the surface that the load acts on.
    pub surface: Surface,
    /// What acts there, by its kind.
    pub load: SurfaceLoad,
    /// How it moves; pressure follows or is dead.
    pub reading: Reading,
    /// JSON path, for messages and reports.
    pub path: String,
}

impl Traction {
    /// True when it does not change as seen from the turning shaft: it follows, or acts along x alone.
    pub fn is_constant_in_turning_frame(&self) -> bool {
        self.reading == Reading::Following
            || matches!(self.load, SurfaceLoad::Traction([_, y, z]) if [y, z] == [0.0; 2])
    }
}
