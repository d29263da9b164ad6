function run = schuler_load(place)
% RUN = SCHULER_LOAD(PLACE) reads run.mat of Schuler (schuler process drive/ --outputs mat): its path, or the folder it is in.
%
% RUN.solution.position is a matrix with a row for each epoch, RUN.solution.time_s the epochs (s on the data set's axis). Beside them
%   RUN.solution.units.position     'deg,deg,m'
%   RUN.solution.columns.position   {'lat', 'lon', 'height'}
% and likewise in RUN.sensor_errors, RUN.innovations.gnss_position, RUN.errors, ... RUN.config are the settings as TOML text,
% RUN.name and RUN.version texts, RUN.origin_s the time that --start, --stop and outages count from.
%
% For Octave and MATLAB.
    if exist(place, 'dir')
        place = fullfile(place, 'run.mat');
    end
    if ~exist(place, 'file')
        error('schuler:load', '%s: no such file; make it with --outputs mat', place);
    end
    run = load(place);
    if ~isfield(run, 'version') || ~isfield(run, 'origin_s')
        error('schuler:load', '%s: is no run.mat of Schuler', place);
    end
    run.origin_s = str2double(run.origin_s);
    names = fieldnames(run);
    for i = 1:numel(names)
        if isstruct(run.(names{i})) && ~strcmp(names{i}, 'about')
            run.(names{i}) = named(run.(names{i}));
        end
    end
end

function group = named(group)
% The struct `about` as units and names of the columns.
    about = struct();
    if isfield(group, 'about')
        about = group.about;
        group = rmfield(group, 'about');
    end
    tables = fieldnames(group);
    for i = 1:numel(tables)
        name = tables{i};
        if isstruct(group.(name))
            group.(name) = named(group.(name));
        elseif isfield(about, name)
            if isfield(about.(name), 'units')
                group.units.(name) = about.(name).units;
            end
            if isfield(about.(name), 'columns')
                group.columns.(name) = strtrim(strsplit(about.(name).columns, ','));
            end
        end
    end
end
