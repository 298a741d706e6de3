// The cells as a tree, by cylinder and address, linked to the view.
import { useVirtualizer } from "@tanstack/react-virtual";
import { ChevronRight } from "lucide-react";
import { useEffect, useMemo, useRef, useState } from "react";
import { typeName } from "../document/cellTypes";
import type { Net } from "../document/net";
import { plainType } from "../document/quantities";
import { inFull } from "../document/scale";
import { clicked } from "../document/selection";
import { select, store } from "../document/store";
import { useStudio } from "./use";

interface Branch {
  address: string;
  /** Row of the expressed cell; -1 where cells lie below. */
  cell: number;
  children: Branch[];
}

interface Row {
  branch: Branch;
  depth: number;
  title: string;
  open: boolean;
}

const ROW = 26; // px

export function CellTree() {
  const net = useStudio((state) => state.net);
  const selection = useStudio((state) => state.selection);
  const hovered = useStudio((state) => (state.hover?.kind === "cell" ? state.hover.row : -1));
  const [open, setOpen] = useState<Set<string>>(new Set());
  const parts = useMemo(() => (net ? treeOf(net) : []), [net]);
  const chosen = useMemo(
    () => new Set(selection.kind === "cells" ? selection.keys : []),
    [selection],
  );
  const rows = useMemo(() => rowsOf(parts, open), [parts, open]);
  const box = useRef<HTMLDivElement>(null);
  const virtual = useVirtualizer({
    count: rows.length,
    getScrollElement: () => box.current,
    estimateSize: () => ROW,
    overscan: 8,
  });

  // What is selected in the view is opened and brought into sight.
  const first = selection.kind === "cells" ? selection.keys[0] : undefined;
  useEffect(() => {
    if (!first || !net) return;
    const cell = net.addresses.indexOf(first);
    if (cell < 0) return;
    const above = first.split(".").map((_, end, all) => all.slice(0, end).join("."));
    setOpen(
      (before) => new Set([...before, `part ${net.cellPart[cell]}`, ...above.filter(Boolean)]),
    );
  }, [first, net]);
  useEffect(() => {
    const at = rows.findIndex(({ branch }) => branch.address === first);
    if (at >= 0) virtual.scrollToIndex(at, { align: "auto" });
  }, [rows, first, virtual]);

  // One row takes the focus; the arrows carry it, also to rows that are not drawn yet.
  const [focus, setFocus] = useState("");
  const carried = useRef(false);
  const tabbed = Math.max(
    0,
    rows.findIndex(({ branch }) => branch.address === (focus || first)),
  );
  const carry = (to: number) => {
    const row = rows[Math.max(0, Math.min(to, rows.length - 1))];
    carried.current = true;
    setFocus(row.branch.address);
    virtual.scrollToIndex(rows.indexOf(row), { align: "auto" });
  };
  useEffect(() => {
    if (!carried.current) return;
    const row = box.current?.querySelector<HTMLElement>('[role=treeitem][tabindex="0"]');
    if (!row) return;
    carried.current = false;
    row.focus();
  });

  if (!net) return null;
  const toggle = (address: string) => {
    setOpen((before) => {
      const after = new Set(before);
      if (!after.delete(address)) after.add(address);
      return after;
    });
  };
  /** Does what a key means in a row; false if it means nothing here. */
  const press = (key: string, index: number, take: () => void): boolean => {
    const { branch, depth, open: isOpen } = rows[index];
    const below = branch.children.length > 0;
    const above = rows.findLastIndex((row, place) => place < index && row.depth < depth);
    switch (key) {
      case "Enter":
      case " ":
        take();
        break;
      case "ArrowDown":
        carry(index + 1);
        break;
      case "ArrowUp":
        carry(index - 1);
        break;
      case "Home":
        carry(0);
        break;
      case "End":
        carry(rows.length - 1);
        break;
      case "ArrowRight":
        if (below && !isOpen) toggle(branch.address);
        else if (below) carry(index + 1);
        break;
      case "ArrowLeft":
        if (below && isOpen) toggle(branch.address);
        else if (above >= 0) carry(above);
        break;
      default:
        return false;
    }
    return true;
  };
  return (
    <div className="tree" ref={box} role="tree" aria-label="Cells" aria-multiselectable="true">
      <div style={{ height: virtual.getTotalSize(), position: "relative" }} role="presentation">
        {virtual.getVirtualItems().map(({ index, start }) => {
          const { branch, depth, title, open: isOpen } = rows[index];
          const below = branch.children.length > 0;
          const leaves = below ? addressesBelow(branch) : [branch.address];
          const isChosen = leaves.length > 0 && leaves.every((address) => chosen.has(address));
          const take = (adding: boolean) => {
            if (below && !adding) select({ kind: "cells", keys: leaves });
            else
              for (const leaf of leaves)
                select(clicked(store.getState().selection, "cells", leaf, adding));
          };
          return (
            <div
              key={branch.address}
              role="treeitem"
              tabIndex={index === tabbed ? 0 : -1}
              aria-level={depth + 1}
              aria-selected={isChosen}
              {...(below ? { "aria-expanded": isOpen } : {})}
              className={
                branch.cell >= 0 && branch.cell === hovered ? "tree-row hovered" : "tree-row"
              }
              style={{ transform: `translateY(${start}px)`, paddingLeft: 8 + 14 * depth }}
              onFocus={() => setFocus(branch.address)}
              onClick={(event) => take(event.shiftKey || event.ctrlKey || event.metaKey)}
              onKeyDown={(event) => {
                if (!press(event.key, index, () => take(event.shiftKey))) return;
                // These keys mean the tree here, whatever they do elsewhere.
                event.preventDefault();
                event.stopPropagation();
              }}
            >
              <button
                type="button"
                tabIndex={-1}
                className={below ? "twist" : "twist leaf"}
                aria-label={isOpen ? "Close" : "Open"}
                aria-hidden={!below}
                onClick={(event) => {
                  event.stopPropagation();
                  toggle(branch.address);
                }}
              >
                {below && <ChevronRight className={isOpen ? "open" : ""} />}
              </button>
              <span>{title}</span>
              <span className="tree-kind">
                {branch.cell >= 0
                  ? `type ${typeName(plainType(net.types[branch.cell]))}`
                  : inFull(leaves.length)}
                {branch.cell >= 0 && net.stored[branch.cell] === 1 && " · off"}
              </span>
            </div>
          );
        })}
      </div>
    </div>
  );
}

function treeOf(net: Net): { name: string; branch: Branch }[] {
  const parts = net.parts.map((name, part) => ({
    name,
    branch: { address: `part ${part}`, cell: -1, children: [] } as Branch,
  }));
  const found = new Map<string, Branch>();
  net.addresses.forEach((address, cell) => {
    const steps = address.split(".");
    let above = parts[net.cellPart[cell]]?.branch ?? parts[0].branch;
    steps.forEach((_, end) => {
      const name = steps.slice(0, end + 1).join(".");
      let branch = found.get(name);
      if (!branch) {
        branch = { address: name, cell: -1, children: [] };
        found.set(name, branch);
        above.children.push(branch);
      }
      above = branch;
    });
    above.cell = cell;
  });
  return parts;
}

function rowsOf(parts: { name: string; branch: Branch }[], open: Set<string>): Row[] {
  const rows: Row[] = [];
  const add = (branch: Branch, depth: number, title: string) => {
    const isOpen = open.has(branch.address);
    rows.push({ branch, depth, title, open: isOpen });
    if (isOpen) for (const child of branch.children) add(child, depth + 1, child.address);
  };
  for (const { name, branch } of parts) add(branch, 0, name);
  return rows;
}

function addressesBelow(branch: Branch): string[] {
  return branch.children.length ? branch.children.flatMap(addressesBelow) : [branch.address];
}
