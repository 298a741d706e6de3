// Nets that are only looked at: fetched a few at a time, the one asked for last first, and kept for a while.
import { fetchPicture } from "../protocol/fetching";
import { type Motion, motionOf } from "./motion";
import { applyNet, type Net } from "./net";

/** A net at equilibrium. */
export interface Pictured {
  net: Net;
  motion: Motion;
}

const MOST_KEPT = 400;

/** Fetched at once; more would keep the engine from what is asked for next. */
const MOST_FETCHED = 3;

/** Time in a frame for what is made of nets that came [ms]. */
const BUDGET = 6;

type Take = (picture: Pictured) => void;

interface Wish {
  path: string;
  name: string;
  take: Take;
}

const known = new Map<string, Pictured>();
const fetched = new Map<string, Wish[]>();
const waiting: Wish[] = [];
const ready: { wish: Wish; picture: Pictured }[] = [];
let asked = false;

/** The net and the state at an address such as `/api/scenes/sheet/picture`. */
export async function pictureAt(path: string): Promise<Pictured> {
  const [net, motion] = await fetchPicture(path);
  if (net.header.frame !== "net" || motion.header.frame !== "motion") throw new Error("no picture");
  return {
    net: applyNet(null, net.header, net.arrays),
    motion: motionOf(motion.header, motion.arrays),
  };
}

/**
 * Hands over the net at an address once it is there and there is time; `revision` tells apart what was there
 * at different times. Returns what takes the wish back.
 */
export function wish(path: string, revision: string, take: Take): () => void {
  const one: Wish = { path, name: `${path} ${revision}`, take };
  const picture = known.get(one.name);
  if (picture) hand(one, picture);
  else waiting.push(one);
  next();
  return () => {
    remove(waiting, one);
    const same = fetched.get(one.name);
    if (same) remove(same, one);
    const at = ready.findIndex((entry) => entry.wish === one);
    if (at >= 0) ready.splice(at, 1);
  };
}

function next(): void {
  while (waiting.length && fetched.size < MOST_FETCHED) {
    // The one asked for last is most likely still in sight.
    const one = waiting.pop()!;
    const same = fetched.get(one.name);
    const picture = known.get(one.name);
    if (picture) hand(one, picture);
    else if (same) same.push(one);
    else void fetchFor(one);
  }
}

async function fetchFor(one: Wish): Promise<void> {
  const wishes = [one];
  fetched.set(one.name, wishes);
  try {
    const picture = await pictureAt(one.path);
    known.set(one.name, picture);
    // The oldest are forgotten: a long run has more pictures than a window can hold.
    if (known.size > MOST_KEPT) known.delete(known.keys().next().value!);
    for (const each of wishes) hand(each, picture);
  } catch {
    // It stays empty; whoever wishes for it again has another try.
  } finally {
    fetched.delete(one.name);
    next();
  }
}

/** Nets are drawn a few in a frame: what came at once would block the page together. */
function hand(wish: Wish, picture: Pictured): void {
  ready.push({ wish, picture });
  if (!asked) requestAnimationFrame(drain);
  asked = true;
}

function drain(): void {
  asked = false;
  const begun = performance.now();
  while (ready.length && performance.now() - begun < BUDGET) {
    const { wish, picture } = ready.shift()!;
    wish.take(picture);
  }
  asked = ready.length > 0;
  if (asked) requestAnimationFrame(drain);
}

function remove<T>(list: T[], one: T): void {
  const at = list.indexOf(one);
  if (at >= 0) list.splice(at, 1);
}
