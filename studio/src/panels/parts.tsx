// Small parts that all panels are made of: buttons with tooltips, keys, numbers, fields.
import { LoaderCircle } from "lucide-react";
import { Tooltip } from "radix-ui";
import { type ComponentProps, type ReactNode, useEffect, useRef, useState } from "react";
import { changeInDigits, inDigits, inFull } from "../document/scale";
import { useStudio } from "./use";

/** What is waited for, if anything is. */
export function Busy() {
  const busy = useStudio((state) => state.busy);
  return (
    <span className="busy" role="status">
      {busy && (
        <>
          <LoaderCircle /> {busy} …
        </>
      )}
    </span>
  );
}

/** Keys as they are printed on a keyboard. */
export function Keys({ keys }: { keys: string }) {
  const apple = /Mac|iP/.test(navigator.platform);
  const names: Record<string, string> = {
    Ctrl: apple ? "⌘" : "Ctrl",
    Shift: "⇧",
    Delete: "Del",
    Escape: "Esc",
  };
  return (
    <span className="keys">
      {keys.split("+").map((key) => (
        <kbd key={key}>{names[key] ?? key}</kbd>
      ))}
    </span>
  );
}

/** Text that appears beside something the pointer rests on. */
export function Hint({
  text,
  keys,
  side = "bottom",
  children,
}: {
  text: string;
  keys?: string | undefined;
  side?: "top" | "right" | "bottom" | "left";
  children: ReactNode;
}) {
  return (
    <Tooltip.Root>
      <Tooltip.Trigger asChild>{children}</Tooltip.Trigger>
      <Tooltip.Portal>
        <Tooltip.Content className="hint" side={side} sideOffset={6} collisionPadding={8}>
          {text}
          {keys && <Keys keys={keys} />}
        </Tooltip.Content>
      </Tooltip.Portal>
    </Tooltip.Root>
  );
}

/** A button that shows an icon and is named by its tooltip. */
export function IconButton({
  label,
  text = label,
  keys,
  side,
  pressed,
  children,
  ...rest
}: {
  label: string;
  /** What its tooltip says, if not its name. */
  text?: string;
  keys?: string | undefined;
  side?: "top" | "right" | "bottom" | "left";
  pressed?: boolean;
} & ComponentProps<"button">) {
  return (
    <Hint text={text} keys={keys} {...(side ? { side } : {})}>
      <button
        type="button"
        className="icon-button"
        aria-label={label}
        aria-pressed={pressed}
        {...rest}
      >
        {children}
      </button>
    </Hint>
  );
}

/** A headed part of a panel. */
export function Section({
  title,
  aside,
  children,
}: {
  title: string;
  aside?: ReactNode;
  children: ReactNode;
}) {
  return (
    <section className="section">
      <header>
        <h2>{title}</h2>
        {aside}
      </header>
      {children}
    </section>
  );
}

function FactName({
  name,
  title,
  onPick,
}: {
  name: string;
  title?: string | undefined;
  onPick?: (() => void) | undefined;
}) {
  const shown = onPick ? (
    <button type="button" className="fact-name fact-pick" onClick={onPick}>
      {name}
    </button>
  ) : (
    <span className="fact-name">{name}</span>
  );
  return title ? (
    <Hint text={title} side="left">
      {shown}
    </Hint>
  ) : (
    shown
  );
}

/** A value with its name, unit and, if it is known, how it changed. */
export function Fact({
  name,
  value,
  unit = "",
  before,
  better,
  digits = 4,
  count = false,
  title,
  onPick,
}: {
  name: string;
  value: number | null | string;
  unit?: string;
  before?: number | null | undefined;
  /** Which way is better; without it a change is only told. */
  better?: "less" | "more";
  digits?: number;
  /** Whether it is a count, which is written out. */
  count?: boolean;
  title?: string;
  /** Shows on the net what the value is of. */
  onPick?(): void;
}) {
  const known = typeof value === "number" && typeof before === "number";
  const rise = known ? value - before : 0;
  const counted = rise === 0 ? null : `${rise > 0 ? "+" : "−"}${inFull(Math.abs(rise))}`;
  const change = !known ? null : count ? counted : changeInDigits(value, before, digits);
  const good = better && (better === "less" ? rise < 0 : rise > 0);
  const tone = !better ? "" : good ? "good" : "bad";
  const shown = typeof value === "string" ? value : count ? inFull(value) : inDigits(value, digits);
  return (
    <div className="fact">
      <FactName name={name} title={title} onPick={onPick} />
      <span className="fact-value">
        {change && <span className={`fact-change ${tone}`}>{change}</span>}
        <span>{shown}</span>
        <span className="unit">{unit}</span>
      </span>
    </div>
  );
}

/** A number that is typed; taken with Enter or on leaving the field. */
export function NumberField({
  label,
  value,
  unit = "",
  onTake,
  least,
  whole,
}: {
  label: string;
  value: number;
  unit?: string;
  /** Takes the number; what resolves to null was refused, and the field goes back to its value. */
  onTake(value: number): unknown;
  least?: number;
  whole?: boolean;
}) {
  const shown = String(Math.round(value * 1e6) / 1e6);
  const [text, setText] = useState(shown);
  const field = useRef<HTMLInputElement>(null);
  useEffect(() => setText(shown), [shown]);
  const number = Number(text.trim().replace(",", "."));
  const valid =
    text.trim() !== "" &&
    Number.isFinite(number) &&
    (least === undefined || number >= least) &&
    (!whole || Number.isInteger(number));
  const take = async () => {
    if (!valid) setText(shown);
    else if (number !== Number(shown) && (await onTake(number)) === null) setText(shown);
  };
  return (
    <label className="number-field">
      <span>{label}</span>
      <input
        ref={field}
        inputMode="decimal"
        value={text}
        aria-invalid={!valid}
        onChange={(event) => setText(event.target.value)}
        onBlur={take}
        onKeyDown={(event) => {
          if (event.key === "Enter") take();
          if (event.key === "Escape") {
            setText(shown);
            field.current?.blur();
          }
        }}
      />
      {unit && <span className="unit">{unit}</span>}
    </label>
  );
}

/** A name, typed in its own place; taken with Enter or on leaving the field, Escape leaves it as it was. */
export function NameField({
  label,
  name,
  most,
  onDone,
}: {
  label: string;
  name: string;
  /** Most characters. */
  most: number;
  /** With the name as it is now; `byKey` if the focus has to go somewhere. */
  onDone(name: string, byKey: boolean): void;
}) {
  // A field that goes away is left, too.
  const done = useRef(false);
  const end = (typed: string, byKey: boolean) => {
    if (done.current) return;
    done.current = true;
    onDone(typed.trim() || name, byKey);
  };
  return (
    <input
      aria-label={label}
      defaultValue={name}
      maxLength={most}
      // biome-ignore lint/a11y/noAutofocus: it was asked for
      autoFocus
      onFocus={(event) => event.target.select()}
      onBlur={(event) => end(event.target.value, false)}
      onKeyDown={(event) => {
        if (event.key !== "Enter" && event.key !== "Escape") return;
        // What gets the focus now is not to be pressed by the same key.
        event.preventDefault();
        end(event.key === "Enter" ? event.currentTarget.value : name, true);
      }}
    />
  );
}

/** Something that can be chosen from a list, and what it means. */
export interface Option<T extends string> {
  value: T;
  name: string;
  explains: string;
}

/** A choice from a list. Browsers that can't lay out a list show each option and its explanation in one line. */
export function Choice<T extends string>({
  label,
  value,
  options,
  onTake,
  hidden,
}: {
  label: string;
  value: T;
  options: Option<T>[];
  onTake(value: T): void;
  /** Whether the label is only for screen readers. */
  hidden?: boolean;
}) {
  return (
    <label className="choice">
      <span className={hidden ? "visually-hidden" : ""}>{label}</span>
      <select value={value} onChange={(event) => onTake(event.target.value as T)}>
        <button type="button">
          <span>{options.find((option) => option.value === value)?.name}</span>
        </button>
        {options.map((option) => (
          <option key={option.value} value={option.value}>
            <span>{option.name}</span>
            <span className="visually-hidden">: </span>
            <small>{option.explains}</small>
          </option>
        ))}
      </select>
    </label>
  );
}
