// The form of a run's and of live evolution's parameters: each field explains itself and says why it was refused.
import { useEffect, useId, useState } from "react";
import { typeNames } from "../document/cellTypes";
import { PARAMETERS, type ParameterName, type Texts } from "../document/parameters";
import { Choice, Hint } from "./parts";

/** Fields of some parameters, in order. */
export function ParameterFields({
  names,
  texts,
  problems,
  labels = {},
  onTake,
  onMend,
}: {
  names: readonly ParameterName[];
  texts: Texts;
  /** Why the engine refused what was typed last, in its own words. */
  problems: Texts;
  /** Other labels than those of a run. */
  labels?: Texts;
  onTake(name: ParameterName, text: string): void;
  /** What was refused is typed anew: its problem goes now, so that nothing moves once the pointer is down elsewhere. */
  onMend(name: ParameterName): void;
}) {
  return (
    <div className="parameters">
      {names.map((name) => (
        <Field
          key={name}
          name={name}
          label={labels[name] ?? PARAMETERS[name].label}
          text={texts[name] ?? ""}
          problem={problems[name] ?? ""}
          onTake={(text) => onTake(name, text)}
          onMend={() => onMend(name)}
        />
      ))}
    </div>
  );
}

interface FieldOf {
  name: ParameterName;
  label: string;
  text: string;
  problem: string;
  onTake(text: string): void;
  onMend(): void;
}

function Field(field: FieldOf) {
  const { name, label, text, problem, onTake } = field;
  const { kind, explanation, options } = PARAMETERS[name];
  const words = useId();
  return (
    <>
      <Hint text={explanation} side="left">
        {kind === "choice" ? (
          <div>
            <Choice label={label} value={text} options={options ?? []} onTake={onTake} />
          </div>
        ) : kind === "check" ? (
          <label className="check">
            <input
              type="checkbox"
              checked={text === "true"}
              aria-describedby={problem ? words : undefined}
              onChange={(event) => onTake(String(event.target.checked))}
            />
            {label}
          </label>
        ) : (
          <div>
            <TypedField {...field} words={words} />
          </div>
        )}
      </Hint>
      {name === "types" && <p className="field-reading">{typeNames(text)}</p>}
      {problem && (
        <p className="problem field-problem" role="alert" id={words}>
          {problem}
        </p>
      )}
    </>
  );
}

/** Taken with Enter or on leaving the field; what was refused stays to be mended, Escape takes it back. */
function TypedField({ label, text, problem, onTake, onMend, words }: FieldOf & { words: string }) {
  const [typed, setTyped] = useState(text);
  useEffect(() => setTyped(text), [text]);
  const take = () => {
    if (typed !== text || problem) onTake(typed);
  };
  return (
    <label className="number-field">
      <span>{label}</span>
      <input
        value={typed}
        aria-invalid={problem !== ""}
        aria-describedby={problem ? words : undefined}
        onChange={(event) => {
          setTyped(event.target.value);
          if (problem) onMend();
        }}
        onBlur={take}
        onKeyDown={(event) => {
          if (event.key === "Enter") take();
          if (event.key !== "Escape") return;
          setTyped(text);
          if (problem) onTake(text);
        }}
      />
    </label>
  );
}
