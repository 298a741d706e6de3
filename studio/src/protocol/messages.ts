// Messages between engine and window, generated from python/springform/studio/messages.py by `make messages`.

/**
 * All of them, for the generator.
 */
export interface Protocol {
  request:
    | EditCells
    | EditSpring
    | MoveAnchor
    | FixNode
    | SeekStress
    | SetValue
    | SetFramework
    | SetSprings
    | DropSprings
    | SetDensity
    | Preview
    | Undo
    | Travel
    | Save
    | Revert
    | Move
    | Evolve
    | SteerRun
    | OpenRun
    | Look
    | Follow
    | Reinstate
    | Pin
    | Unpin
    | RenamePin
    | LiveEvolve
    | WeighCells
    | SelectCells
    | AskSymmetry
    | ListPatches
    | CopyPatch
    | RenamePatch
    | DeletePatch
    | PlanGraft
    | Graft
    | Hold
    | Release
    | Received;
  event: DocumentState | RunState | Pins | LiveState | Patches | Welcome | Reply | Problem;
  frame: NetHeader | MotionHeader | TableHeader;
  shelf: Shelf;
  folder: Folder;
  opening: Opening;
  opened: Opened;
  refusal: Refusal;
  lineage: Lineage;
  brushes: Brushes;
  clusters: Clusters;
  comparing: Comparing;
  compared: Compared;
  curve: CurvePoints;
}
/**
 * Subdivide, switch off, switch on or retype cells.
 */
export interface EditCells {
  type: "edit_cells";
  id: number;
  what: "subdivide" | "off" | "on" | "retype" | "turn";
  /**
   * @minItems 1
   * @maxItems 100000
   */
  cells: string[];
  /**
   * Cell type of the children, or the new type.
   */
  kind: string | null;
  /**
   * Whether the images under the framework's symmetries are edited too.
   */
  orbit: boolean;
}
/**
 * Cut the spring between two nodes, or add one.
 */
export interface EditSpring {
  type: "edit_spring";
  id: number;
  what: "cut" | "add";
  /**
   * @minItems 2
   * @maxItems 2
   */
  nodes: string[];
  /**
   * Whether the images under the framework's symmetries are cut or added too.
   */
  orbit: boolean;
}
/**
 * Hold an anchor somewhere else.
 */
export interface MoveAnchor {
  type: "move_anchor";
  id: number;
  anchor: string;
  /**
   * @minItems 3
   * @maxItems 3
   */
  position: number[];
}
/**
 * Make a base vertex an anchor where it is now, hold an anchor otherwise, or let it go.
 */
export interface FixNode {
  type: "fix_node";
  id: number;
  node: string;
  fixed: boolean;
  /**
   * Along which axes it is held; it slides along the others.
   */
  holds: "x" | "y" | "z" | "xy" | "xz" | "yz" | "xyz";
  /**
   * Direction of a line on which it slides.
   */
  line: number[] | null;
  /**
   * Normal of a plane in which it slides.
   */
  plane: number[] | null;
}
/**
 * Subdivide the cell of highest inner force, a number of times.
 */
export interface SeekStress {
  type: "seek_stress";
  id: number;
  steps: number;
  kind: string;
  /**
   * Whether a step subdivides all images of the cell under the framework's symmetries.
   */
  orbit: boolean;
}
/**
 * Change a value of the design file.
 */
export interface SetValue {
  type: "set_value";
  id: number;
  label: string;
  /**
   * @maxItems 20
   */
  path: (string | number)[];
  value: unknown;
}
/**
 * Change the framework; cells that no longer fit start anew.
 */
export interface SetFramework {
  type: "set_framework";
  id: number;
  framework: {
    [k: string]: unknown;
  };
}
/**
 * Say law, unstressed length, sense or section of some springs, as a group of the file does.
 */
export interface SetSprings {
  type: "set_springs";
  id: number;
  choice: SpringChoice;
  /**
   * By the keys of `springs.groups`; null takes back what was said of these springs.
   */
  says: {
    [k: string]: unknown;
  };
}
/**
 * Which springs: those that meet all that is said, all springs if nothing is.
 */
export interface SpringChoice {
  parts: string[] | null;
  types: (number | string)[] | null;
  levels: number[] | null;
  along: string[] | null;
  /**
   * Springs by their two node keys, such as "v1 e7:1/2".
   */
  pairs: string[] | null;
}
/**
 * Take back all that a group says of its springs.
 */
export interface DropSprings {
  type: "drop_springs";
  id: number;
  group: number;
}
/**
 * Bring all cells of a cylinder or sheet, or of the net, to one level.
 */
export interface SetDensity {
  type: "set_density";
  id: number;
  /**
   * None: the whole net.
   */
  part: string | null;
  level: number;
}
/**
 * Tell what an action would do, and do nothing.
 */
export interface Preview {
  type: "preview";
  id: number;
  action: EditCells | EditSpring | SeekStress | SetDensity | SetValue | SetSprings;
}
/**
 * Undo the last action, or redo the one that was undone last.
 */
export interface Undo {
  type: "undo";
  id: number;
  redo: boolean;
}
/**
 * Undo or redo until a number of actions is done.
 */
export interface Travel {
  type: "travel";
  id: number;
  position: number;
}
/**
 * Write the design file; a path makes it the document's file.
 */
export interface Save {
  type: "save";
  id: number;
  path: string | null;
  /**
   * Whether another file that exists is replaced.
   */
  replace: boolean;
}
/**
 * Put back what the document's file holds; an action like any other.
 */
export interface Revert {
  type: "revert";
  id: number;
}
/**
 * Let the net move, stop it, make one step, or put it back to where it was drawn.
 */
export interface Move {
  type: "move";
  id: number;
  what: "run" | "pause" | "step" | "reset";
}
/**
 * Start a run with parameters; what is left out has its default.
 */
export interface Evolve {
  type: "evolve";
  id: number;
  /**
   * The net that it starts from.
   */
  side: string;
  parameters: {
    [k: string]: unknown;
  };
}
/**
 * Pause a run, let it go on, end it, or change parameters from the next generation on.
 */
export interface SteerRun {
  type: "steer_run";
  id: number;
  what: "pause" | "continue" | "stop" | "change";
  parameters: {
    [k: string]: unknown;
  };
}
/**
 * Show another run of the document, to look at and to go on with.
 */
export interface OpenRun {
  type: "open_run";
  id: number;
  number: number;
}
/**
 * Show a parent or an individual of the run instead of the design, or the design again.
 */
export interface Look {
  type: "look";
  id: number;
  /**
   * None: the design.
   */
  generation: number | null;
  /**
   * None: the parent that the generation chose.
   */
  individual: number | null;
  /**
   * What is pinned, instead of a generation.
   */
  pin: number | null;
}
/**
 * Show the parent of the newest generation for as long as the run goes on, or no longer.
 */
export interface Follow {
  type: "follow";
  id: number;
  on: boolean;
}
/**
 * Make a net the design; it is named, since what is shown changes while a run is followed.
 */
export interface Reinstate {
  type: "reinstate";
  id: number;
  side: string;
}
/**
 * Pin a net, so that it is at hand whatever becomes of its run.
 */
export interface Pin {
  type: "pin";
  id: number;
  side: string;
}
/**
 * Let a pinned net go.
 */
export interface Unpin {
  type: "unpin";
  id: number;
  pin: number;
}
/**
 * Call a pinned net something else.
 */
export interface RenamePin {
  type: "rename_pin";
  id: number;
  pin: number;
  label: string;
}
/**
 * Let the net evolve before one's eyes, steer it, and keep or discard what it grew.
 */
export interface LiveEvolve {
  type: "live_evolve";
  id: number;
  /**
   * `change` and `defaults` are for parameters, whether something evolves or not; `restore`
   * brings back what was discarded last.
   */
  what: "start" | "pause" | "continue" | "change" | "defaults" | "keep" | "discard" | "restore";
  /**
   * Of `start` and `change`; others stay as they are.
   */
  parameters: {
    [k: string]: unknown;
  };
}
/**
 * Brush a factor on the chance that evolution changes cells, and what descends from them.
 */
export interface WeighCells {
  type: "weigh_cells";
  id: number;
  /**
   * None at all with no factor: all cells.
   *
   * @maxItems 100000
   */
  cells: string[];
  /**
   * 0: keep out; None: as if nothing had been brushed.
   */
  factor: number | null;
}
/**
 * Find the cells that words select in what is shown; the reply names them.
 */
export interface SelectCells {
  type: "select_cells";
  id: number;
  /**
   * A selection as files and the command line have it, such as ``rings(A7, 2)``.
   */
  words: string | null;
  /**
   * Cells to start from, if there are no words.
   *
   * @maxItems 100000
   */
  cells: string[];
  /**
   * Rings of cells round the anchor that is resolved best, instead of words.
   */
  around_best: number | null;
  /**
   * Rings of cells to add to them, or to take away.
   */
  grow: number;
  /**
   * Whether their images under the framework's symmetries are selected too.
   */
  orbit: boolean;
}
/**
 * Ask which symmetries the framework has, and whether the net has them too.
 */
export interface AskSymmetry {
  type: "ask_symmetry";
  id: number;
}
/**
 * Read the folder of patches again.
 */
export interface ListPatches {
  type: "list_patches";
  id: number;
}
/**
 * Lift a patch from a net and keep it in the folder of patches.
 *
 * The net is named, since what is shown changes while a run is followed.
 */
export interface CopyPatch {
  type: "copy_patch";
  id: number;
  name: string;
  /**
   * @minItems 1
   * @maxItems 100000
   */
  cells: string[];
  /**
   * Anchor that it is seen from.
   */
  anchor: string | null;
  /**
   * Top-level cell that it is seen from; None of both: whatever needs the fewest words.
   */
  seed: number | null;
  side: string;
}
/**
 * Give a patch another name.
 */
export interface RenamePatch {
  type: "rename_patch";
  id: number;
  patch: string;
  name: string;
}
/**
 * Delete the file of a patch.
 */
export interface DeletePatch {
  type: "delete_patch";
  id: number;
  patch: string;
}
/**
 * Ask where a patch would come to lie and, if wanted, what it would change.
 */
export interface PlanGraft {
  patch: string;
  /**
   * Top-level cell that the seed is set on.
   */
  cell: number | null;
  /**
   * Anchor that it is set on; None of both: every anchor.
   */
  anchor: string | null;
  /**
   * Steps: quarter turns, or round an anchor from cell to cell while the patch stays whole.
   */
  rotate: number;
  mirror: boolean;
  /**
   * Whether it is set on all images under the framework's symmetries.
   */
  orbit: boolean;
  type: "plan_graft";
  id: number;
  measure: boolean;
}
/**
 * Set a patch on the design.
 */
export interface Graft {
  patch: string;
  /**
   * Top-level cell that the seed is set on.
   */
  cell: number | null;
  /**
   * Anchor that it is set on; None of both: every anchor.
   */
  anchor: string | null;
  /**
   * Steps: quarter turns, or round an anchor from cell to cell while the patch stays whole.
   */
  rotate: number;
  mirror: boolean;
  /**
   * Whether it is set on all images under the framework's symmetries.
   */
  orbit: boolean;
  type: "graft";
  id: number;
}
/**
 * Hold a node somewhere for as long as it is dragged.
 */
export interface Hold {
  type: "hold";
  node: string;
  /**
   * @minItems 3
   * @maxItems 3
   */
  position: number[];
}
/**
 * Let the dragged node go.
 */
export interface Release {
  type: "release";
}
/**
 * A frame of motion was drawn; the engine may send another.
 */
export interface Received {
  type: "received";
}
/**
 * The document as it is now.
 */
export interface DocumentState {
  type: "document";
  document: string;
  name: string;
  /**
   * The design file that saving writes.
   */
  file: string | null;
  /**
   * Whether that file holds the document as it is now.
   */
  saved: boolean;
  method: string;
  /**
   * Revision of the net.
   */
  revision: number;
  /**
   * Actions done.
   */
  position: number;
  /**
   * Actions that are done or can be redone.
   */
  length: number;
  /**
   * The actions round the position, in order.
   */
  history: HistoryLine[];
  figures: Figures;
  own: Figures1;
  /**
   * Figures before the last action; None at the start.
   */
  before: Figures | null;
  anchors: AnchorState[];
  cell_types: CellTypeChoice[];
  framework: {
    [k: string]: unknown;
  };
  stiffness: number;
  ring_factor: number;
  /**
   * What is said of some springs; of two that say the same of a spring, the later counts.
   */
  spring_groups: SpringGroupLine[];
  /**
   * What is shown instead of the design; figures and net are of that.
   */
  looking: Looked | null;
}
/**
 * One action of the history.
 */
export interface HistoryLine {
  label: string;
  /**
   * Actions done once this one is, from 1.
   */
  number: number;
  /**
   * Where the net was taken from, if it was taken over as a whole.
   */
  origin: Place | null;
}
/**
 * Where a net comes from: a parent or an individual of a run.
 */
export interface Place {
  /**
   * Folder of the run: within the document's folder, such as ``runs/0001``, or absolute.
   */
  run: string;
  /**
   * 0 is the start.
   */
  generation: number;
  /**
   * None: the parent for the next generation.
   */
  individual: number | null;
}
/**
 * Measures of the net at equilibrium.
 */
export interface Figures {
  springs: number;
  nodes: number;
  cells: number;
  force_differential: number | null;
  force_min: number;
  force_max: number;
  force_mean: number;
  total_length: number;
  area: number;
  shortest_spring: number;
  converged: boolean;
  reason: string;
}
/**
 * Measures of the net at equilibrium.
 */
export interface Figures1 {
  springs: number;
  nodes: number;
  cells: number;
  force_differential: number | null;
  force_min: number;
  force_max: number;
  force_mean: number;
  total_length: number;
  area: number;
  shortest_spring: number;
  converged: boolean;
  reason: string;
}
/**
 * An anchor as the design file holds it.
 */
export interface AnchorState {
  name: string;
  node: string;
  /**
   * @minItems 3
   * @maxItems 3
   */
  position: number[];
  /**
   * Along which axes it is held.
   */
  holds: string;
  /**
   * Direction of the line on which it slides.
   */
  line: number[] | null;
  /**
   * Normal of the plane in which it slides.
   */
  plane: number[] | null;
}
/**
 * A cell type that the method allows.
 */
export interface CellTypeChoice {
  word: string;
  name: string;
}
/**
 * A group of springs of the design file, for people.
 */
export interface SpringGroupLine {
  /**
   * Which springs.
   */
  title: string;
  /**
   * What of them.
   */
  says: string;
}
/**
 * A parent, an individual or something pinned that is shown instead of the design.
 */
export interface Looked {
  /**
   * Such as ``Generation 34, individual 2``.
   */
  label: string;
  /**
   * In the document's run; None: it is pinned, and of no run or of an earlier one.
   */
  generation: number | null;
  individual: number | null;
  /**
   * Of what is in no generation of the run.
   */
  pin: number | null;
}
/**
 * The run of the document that is shown, and which others there are.
 */
export interface RunState {
  type: "run";
  status: "none" | "running" | "paused" | "ended" | "failed";
  reason: string;
  folder: string;
  /**
   * The folder as pins and the history name it.
   */
  name: string;
  /**
   * Another process that drives it; empty: this studio does, or nobody.
   */
  driver: string;
  following: boolean;
  parameters: {
    [k: string]: unknown;
  };
  /**
   * Of the design that it started from.
   */
  start_springs: number;
  start_differential: number | null;
  /**
   * All runs of the document, the newest first; the one that is shown has its `name`.
   */
  runs: RunLine[];
  /**
   * Generations made.
   */
  generations: number;
  /**
   * Generation of the first row; earlier ones are as they were told before.
   */
  first: number;
  rows: GenerationRow[];
}
/**
 * A run of the document, in short.
 */
export interface RunLine {
  /**
   * In the order in which they were started, from 1.
   */
  number: number;
  /**
   * Its folder, as pins and the history name it.
   */
  name: string;
  generations: number;
  /**
   * Of its last parent.
   */
  springs: number;
  force_differential: number | null;
  /**
   * What its best has least of.
   */
  fitness: string;
}
/**
 * What a generation gave: its parent now, and the force differentials of its individuals.
 */
export interface GenerationRow {
  generation: number;
  springs: number;
  force_differential: number | null;
  suf: number | null;
  /**
   * Individual that became parent; None: the parent stayed.
   */
  winner: number | null;
  least: number | null;
  /**
   * First quartile.
   */
  low: number | null;
  median: number | null;
  /**
   * Third quartile.
   */
  high: number | null;
  /**
   * Parameters were changed after it.
   */
  changed: boolean;
}
/**
 * What is pinned, in the order in which it was.
 */
export interface Pins {
  type: "pins";
  pins: PinState[];
}
/**
 * A pinned net.
 */
export interface PinState {
  number: number;
  /**
   * What it is called: such as ``Generation 34, individual 2``, until somebody renames it.
   */
  label: string;
  /**
   * None: it was the design, after actions of its own.
   */
  place: Place | null;
  /**
   * Spring utilization factor in its run; None if it is undefined.
   */
  suf: number | null;
  figures: Figures;
}
/**
 * Live evolution, and the cells that were brushed.
 */
export interface LiveState {
  type: "live";
  status: "none" | "running" | "paused" | "failed";
  /**
   * Why it failed or stands still; empty: because it was told to.
   */
  reason: string;
  generation: number;
  /**
   * Generations a second.
   */
  rate: number;
  /**
   * Of the last generations.
   */
  points: LivePoint[];
  parameters: {
    [k: string]: unknown;
  };
  /**
   * Names of the parameters that differ from their defaults.
   */
  changed: string[];
  /**
   * Factors by address of cells.
   */
  weights: {
    [k: string]: number;
  };
  /**
   * Whether something was discarded that can be brought back.
   */
  restorable: boolean;
}
/**
 * What a generation of live evolution gave.
 */
export interface LivePoint {
  generation: number;
  springs: number;
  force_differential: number | null;
}
/**
 * The folder of patches.
 */
export interface Patches {
  type: "patches";
  folder: string;
  patches: PatchEntry[];
}
/**
 * A patch of the folder.
 */
export interface PatchEntry {
  name: string;
  /**
   * Why the file can't be used; empty if it can.
   */
  problem: string;
  anchored: boolean;
  tiles: PatchTile[];
  /**
   * Top-level cells.
   */
  top_level: number;
  /**
   * Where it comes from, in words.
   */
  origin: string;
  /**
   * Largest force in its cells where it comes from [N].
   */
  force_max: number | null;
}
/**
 * A cell of a patch, laid out flat.
 */
export interface PatchTile {
  /**
   * Left, in top-level cells from the seed.
   */
  x: number;
  /**
   * Bottom.
   */
  y: number;
  size: number;
  /**
   * Cell type.
   */
  kind: string;
}
/**
 * First message to a window.
 */
export interface Welcome {
  type: "welcome";
  /**
   * Hash of these declarations; a window of another protocol must be loaded anew.
   */
  protocol: string;
  version: string;
}
/**
 * Answer to a request.
 */
export interface Reply {
  type: "reply";
  id: number;
  /**
   * What is wrong and what to do; None: it was done.
   */
  problem: string | null;
  /**
   * What the problem is about, such as a parameter, where that is known.
   */
  key: string | null;
  /**
   * Cells that the action made or changed.
   */
  cells: string[];
  /**
   * What was asked by `preview`.
   */
  preview: PreviewState | null;
  /**
   * What else was asked for.
   */
  answer: (SymmetryState | GraftPlan) | null;
}
/**
 * What an action would do.
 */
export interface PreviewState {
  springs_added: number;
  springs_removed: number;
  cells_added: number;
  cells_removed: number;
  figures: Figures2;
  /**
   * Ends of the springs that would come, six numbers each [m]; empty if they are very many.
   */
  added: number[];
  /**
   * Ends of the springs that would go, six numbers each [m]; empty if they are very many.
   */
  removed: number[];
}
/**
 * Measures of the net at equilibrium.
 */
export interface Figures2 {
  springs: number;
  nodes: number;
  cells: number;
  force_differential: number | null;
  force_min: number;
  force_max: number;
  force_mean: number;
  total_length: number;
  area: number;
  shortest_spring: number;
  converged: boolean;
  reason: string;
}
/**
 * The symmetries of the framework.
 */
export interface SymmetryState {
  type: "symmetry";
  /**
   * With the identity.
   */
  rotations: number;
  mirrors: number;
  /**
   * Where the net does not have them; empty: it does.
   */
  broken: string;
  /**
   * Why they can't be used; empty: they can.
   */
  problem: string;
}
/**
 * What a graft would do.
 */
export interface GraftPlan {
  type: "plan";
  placed: PlacedPatch[];
  /**
   * What would be left out, and why.
   */
  skipped: string[];
  /**
   * Borders of the cells that are written, a segment six numbers [m].
   */
  outline: number[];
  /**
   * Springs of these cells [m].
   */
  springs: number[];
  /**
   * Steps of rotation after which it lies as at first; 1: it lies whole in one way only.
   */
  turns: number;
  before: GraftFigures | null;
  after: GraftFigures | null;
}
/**
 * A patch where it would be set.
 */
export interface PlacedPatch {
  /**
   * Top-level cell of the seed.
   */
  cell: number;
  anchor: string | null;
  /**
   * Top-level cells that are written.
   */
  cells: number[];
}
/**
 * What a graft changes.
 */
export interface GraftFigures {
  springs: number;
  force_differential: number | null;
  force_max: number;
  force_min: number;
  /**
   * Nodes at the end of a single spring, and no anchor.
   */
  dangling: number;
  converged: boolean;
}
/**
 * Something went wrong that no request asked for.
 */
export interface Problem {
  type: "problem";
  message: string;
}
/**
 * A net, as what differs from an earlier one.
 */
export interface NetHeader {
  frame: "net";
  revision: number;
  /**
   * Revision that runs refer to; None: there are no runs.
   */
  base: number | null;
  parts: string[];
  anchor_names: string[];
  /**
   * Of new nodes.
   */
  node_keys: string[];
  /**
   * Of new cells.
   */
  addresses: string[];
  /**
   * Of new cells.
   */
  types: string[];
  arrays: ArrayHeader[];
}
/**
 * One array of a frame.
 */
export interface ArrayHeader {
  name: string;
  type: "float32" | "int32" | "uint8";
  length: number;
}
/**
 * Where the net is, and what its springs carry.
 */
export interface MotionHeader {
  frame: "motion";
  /**
   * Revision of the net that the arrays belong to.
   */
  revision: number;
  /**
   * Steps made since the net was last disturbed.
   */
  steps: number;
  running: boolean;
  /**
   * Nothing will move until something changes.
   */
  settled: boolean;
  converged: boolean;
  /**
   * Largest force out of balance over the mean spring force; None if it is undefined.
   */
  residual: number | null;
  reason: string;
  /**
   * Nodes that are dragged.
   */
  held: number[];
  /**
   * Force with which each of them is held there [N].
   */
  held_by: number[];
  /**
   * From the change that it follows until its step began [s]; 0 of later steps.
   */
  waited: number;
  /**
   * What its step took [s].
   */
  took: number;
  arrays: ArrayHeader[];
}
/**
 * Measures of all individuals from a generation on.
 */
export interface TableHeader {
  frame: "table";
  /**
   * Generation of the first individual.
   */
  first: number;
  population: number;
  arrays: ArrayHeader[];
}
/**
 * What can be opened.
 */
export interface Shelf {
  scenes: SceneEntry[];
  documents: DocumentEntry[];
}
/**
 * A packaged scene.
 */
export interface SceneEntry {
  name: string;
  description: string;
}
/**
 * A document that was worked on before.
 */
export interface DocumentEntry {
  id: string;
  name: string;
  file: string | null;
  /**
   * Seconds since 1970.
   */
  changed: number;
  open: boolean;
}
/**
 * A folder of this machine, as far as the studio can open what is in it.
 */
export interface Folder {
  path: string;
  parent: string | null;
  entries: FolderEntry[];
}
/**
 * What can be opened or entered in a folder.
 */
export interface FolderEntry {
  name: string;
  kind: "folder" | "design" | "run";
}
/**
 * Ask for a new document from a scene or a design file.
 */
export interface Opening {
  source: string;
}
/**
 * The document that was opened.
 */
export interface Opened {
  id: string;
  /**
   * Whether it is a file's document, with changes since it was saved.
   */
  went_on: boolean;
}
/**
 * Why something that was fetched is refused.
 */
export interface Refusal {
  problem: string;
}
/**
 * Where an individual came from, the last step last.
 */
export interface Lineage {
  steps: LineageStep[];
}
/**
 * An ancestor, or the individual itself: what its mutation changed.
 */
export interface LineageStep {
  generation: number;
  individual: number;
  springs: number;
  force_differential: number | null;
  /**
   * Such as ``12.0 subdivide 1 1 6 1``.
   */
  edits: string[];
}
/**
 * Ask for clusters of what is brushed on axes.
 */
export interface Brushes {
  /**
   * Least and most by axis.
   */
  brushes: {
    /**
     * @minItems 2
     * @maxItems 2
     */
    [k: string]: number[];
  };
  count: number;
}
/**
 * Clusters of what is brushed, the largest first.
 */
export interface Clusters {
  /**
   * Individuals that are brushed.
   */
  brushed: number;
  clusters: Cluster[];
}
/**
 * A cluster of individuals, by the one nearest to its middle.
 */
export interface Cluster {
  generation: number;
  individual: number;
  size: number;
}
/**
 * Ask for two nets, compared.
 */
export interface Comparing {
  first: string;
  second: string;
}
/**
 * Two nets, compared.
 */
export interface Compared {
  first: ComparedNet;
  second: ComparedNet;
  /**
   * Top-level cells whose subtrees differ; None on different frameworks.
   */
  changed: number | null;
  types: ComparedCount[];
  reactions: ComparedReaction[];
}
/**
 * One of two nets at equilibrium.
 */
export interface ComparedNet {
  label: string;
  figures: Figures;
  /**
   * Standard deviation of the forces [N].
   */
  force_deviation: number;
  /**
   * Sum of force times length [N m].
   */
  load_path: number;
  /**
   * Of all anchors [N].
   */
  largest_reaction: number;
}
/**
 * Expressed cells of a type.
 */
export interface ComparedCount {
  name: string;
  first: number;
  second: number;
}
/**
 * What holds an anchor [N]; None where a net does not have it.
 */
export interface ComparedReaction {
  anchor: string;
  first: number | null;
  second: number | null;
}
/**
 * A measured curve, as it was read from a CSV file.
 */
export interface CurvePoints {
  strains: number[];
  /**
   * Of every test point [N].
   */
  forces: number[];
}
