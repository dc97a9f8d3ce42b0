!> Reader that converts namelist text to a validated case.
module rwmf_input_reader
   use rwmf_core_error, only: add_context, err_input, error_t, fail
   use rwmf_core_kinds, only: wp
   use rwmf_input_namelist, only: entry_t, group_t, parse_namelist
   use rwmf_input_record_record_reader, only: make_record, read_record
   use rwmf_input_record_samples, only: samples_t
   use rwmf_input_schema, only: all_groups, keys_of
   use rwmf_input_schema_check, only: check_groups, check_values, collect_values
   use rwmf_input_unit_conversion, only: check_units, convert_units
   use rwmf_problem_case, only: case_t
   use rwmf_problem_case_group, only: case_group_t
   use rwmf_problem_group_values, only: applies, group_values_t, has_group, has_key, key_line, &
      text_of
   use rwmf_problem_key, only: key_t
   use rwmf_problem_record, only: record_source_t, record_t, set_factor
   use rwmf_problem_units, only: unit_mass
   use rwmf_text_atomic_file, only: join_path
   use rwmf_text_file, only: read_file
   use rwmf_text_strings, only: integer_to_text, real_to_text, shown, to_lower
   implicit none
   private

   public :: read_case_file, read_case_text, fill_case, end_with_records

contains

   !> Read and validate a case file and its records.
   !>
   !> Errors: an unreadable file, and those of `read_case_text`; messages begin with the path.
   subroutine read_case_file(path, case, error)
      character(*), intent(in) :: path
      !! path of the file; relative paths in the file refer to its folder
      type(case_t), intent(out) :: case
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: text

      call read_file(path, text, error)
      if (.not. allocated(error)) then
         call read_case_text(text, path(:index(path, '/', back=.true.)), case, error)
      end if
      if (allocated(error)) call add_context(error, path)
   end subroutine read_case_file

   !> Read and validate a case and its records.
   !>
   !> Errors: text that is not a namelist, unknown or repeated groups and keys, invalid values,
   !> contradictory groups, a missing or damaged record.
   subroutine read_case_text(text, folder, case, error, known, motion, vertical, is_for_host)
      character(*), intent(in) :: text
      !! namelist text
      character(*), intent(in) :: folder
      !! base of relative paths in the text; '' is the current folder
      type(case_t), intent(out) :: case
      type(error_t), allocatable, intent(out) :: error
      type(case_t), intent(in), optional :: known
      !! case whose samples are reused for the same record, to avoid reading its file again
      type(samples_t), intent(in), optional :: motion
      !! samples of `&motion`; its `file` is then only a name, and no file is read
      type(samples_t), intent(in), optional :: vertical
      !! samples of `&vertical`; its `file` is then only a name, and no file is read
      logical, intent(in), optional :: is_for_host
      !! the case is for an element or a member of a host program: T_s and xi_s of `&frame` and the
      !! end of the simulation may be absent; default false
      type(group_t), allocatable :: given(:)
      type(case_group_t), allocatable :: groups(:)
      type(key_t), allocatable :: keys(:)

      call parse_namelist(text, given, error)
      if (allocated(error)) return
      if (present(is_for_host)) then
         if (is_for_host) call add_unused_keys(given)
      end if
      groups = all_groups()
      keys = keys_of(groups)
      call collect_values(given, groups, keys, case%values, error)
      if (.not. allocated(error)) call check_groups(case%values, groups, error)
      if (.not. allocated(error)) call check_units(case%values, keys, error)
      if (.not. allocated(error)) call convert_units(case%values, groups, error)
      if (.not. allocated(error)) call check_values(case%values, groups, error)
      if (allocated(error)) return
      case%text = text
      call fill_case(case, groups, error)
      if (.not. allocated(error)) then
         call read_records(folder, case, error, known, motion, vertical)
      end if
      if (.not. allocated(error)) call end_with_records(case, error)
   end subroutine read_case_text

   !> Add the keys that a case needs and an element or a member does not use, where they are absent.
   subroutine add_unused_keys(given)
      type(group_t), allocatable, intent(inout) :: given(:)
      type(group_t), allocatable :: groups(:)
      logical :: has_mass
      integer :: i

      if (find_group(given, 'solver') == 0) then
         ! element by element, as an array constructor of gfortran 12 loses keys
         allocate (groups(size(given) + 1))
         groups(:size(given)) = given
         groups(size(groups))%name = 'solver'
         groups(size(groups))%line = 1
         allocate (groups(size(groups))%entries(0))
         call move_alloc(groups, given)
      end if
      call add_key('solver', 't_end', '1')
      if (find_group(given, 'frame') == 0) return
      call add_key('frame', 'xi_s', '0')
      associate (own => given(find_group(given, 'frame')))
         has_mass = .false.
         do i = 1, size(own%entries)
            if (any(own%entries(i)%key == [character(5) :: 'gamma', 'm_s'])) has_mass = .true.
         end do
      end associate
      ! only a frame with a mass has a period
      if (has_mass) call add_key('frame', 'T_s', '1', instead='k_s')

   contains

      !> Add a key unless it, or another in its place, is given.
      subroutine add_key(group, key, value, instead)
         character(*), intent(in) :: group, key, value
         character(*), intent(in), optional :: instead
         type(entry_t), allocatable :: entries(:)
         integer :: i

         associate (own => given(find_group(given, group)))
            do i = 1, size(own%entries)
               if (own%entries(i)%key == to_lower(key)) return
               if (.not. present(instead)) cycle
               if (own%entries(i)%key == instead) return
            end do
            allocate (entries(size(own%entries) + 1))
            entries(:size(own%entries)) = own%entries
            associate (added => entries(size(entries)))
               added%key = to_lower(key)
               added%line = own%line
               allocate (added%values(1))
               added%values(1)%text = value
               added%is_quoted = .false.
            end associate
            call move_alloc(entries, own%entries)
         end associate
      end subroutine add_key
   end subroutine add_unused_keys

   !> Index of a group, 0 if it is not given.
   pure integer function find_group(given, name) result(i)
      type(group_t), intent(in) :: given(:)
      character(*), intent(in) :: name
      !! in lower case

      do i = size(given), 1, -1
         if (given(i)%name == name) return
      end do
   end function find_group

   !> Fill the case from every group that applies; `&output` has a meaning without being given.
   subroutine fill_case(case, groups, error)
      type(case_t), intent(inout) :: case
      !! case with its values, otherwise empty
      type(case_group_t), intent(in) :: groups(:)
      !! `all_groups`
      type(error_t), allocatable, intent(out) :: error
      !! `err_input` if the storeys have no first mode
      integer :: i

      case%unit_mass = unit_mass(case%values)
      case%follows_size = case%values%has_units .and. has_group(case%values, 'wall') &
         .and. case%unit_mass > 0
      do i = 1, size(groups)
         if (.not. (applies(case%values, trim(groups(i)%name)) &
            .or. groups(i)%name == 'output')) cycle
         if (.not. associated(groups(i)%fill)) cycle
         call groups(i)%fill(case, error)
         if (allocated(error)) return
      end do
   end subroutine fill_case

   !> Read the records of the horizontal and the vertical motion.
   subroutine read_records(folder, case, error, known, motion, vertical)
      character(*), intent(in) :: folder
      type(case_t), intent(inout) :: case
      type(error_t), allocatable, intent(out) :: error
      type(case_t), intent(in), optional :: known
      type(samples_t), intent(in), optional :: motion
      type(samples_t), intent(in), optional :: vertical

      if (present(motion) .and. .not. has_key(case%values, 'motion', 'file')) then
         call fail(error, err_input, '&motion: samples are given, but no key file that names them')
      else if (present(motion)) then
         call add_samples('motion', motion, case%values, case%model%g, case%motion, case%record, &
            error)
      else if (has_key(case%values, 'motion', 'file')) then
         call add_record('motion', folder, case%values, case%model%g, case%motion, case%record, &
            error, known)
      end if
      if (allocated(error)) return
      if (present(vertical) .and. .not. has_key(case%values, 'vertical', 'file')) then
         call fail(error, err_input, '&vertical: samples are given, but no key file that names ' &
            //'them')
      else if (present(vertical)) then
         call add_samples('vertical', vertical, case%values, case%model%g, case%upward, &
            case%upward_record, error)
      else if (has_key(case%values, 'vertical', 'file')) then
         call add_record('vertical', folder, case%values, case%model%g, case%upward, &
            case%upward_record, error, known)
      end if
   end subroutine read_records

   !> Make the record of a group from samples.
   subroutine add_samples(group, samples, values, g, source, record, error)
      character(*), intent(in) :: group
      type(samples_t), intent(in) :: samples
      type(group_values_t), intent(in) :: values
      real(wp), intent(in) :: g
      !! acceleration of unit 'g' [m/s2]
      class(record_source_t), intent(inout) :: source
      type(record_t), allocatable, intent(out) :: record
      type(error_t), allocatable, intent(out) :: error

      ! samples of an array have no file
      source%path = ''
      allocate (record)
      call make_record(samples, source%dt, source%unit, source%scale, g, record, error)
      if (allocated(error)) call add_file(values, group, error)
   end subroutine add_samples

   !> Read the record of a group.
   subroutine add_record(group, folder, values, g, source, record, error, known)
      character(*), intent(in) :: group
      character(*), intent(in) :: folder
      type(group_values_t), intent(in) :: values
      real(wp), intent(in) :: g
      !! acceleration of unit 'g' [m/s2]
      class(record_source_t), intent(inout) :: source
      type(record_t), allocatable, intent(out) :: record
      type(error_t), allocatable, intent(out) :: error
      type(case_t), intent(in), optional :: known

      source%path = join_path(folder, source%file)
      if (index(source%file, '/') == 1) source%path = source%file
      if (present(known)) call take_record(known, source, record)
      ! an unallocated component is passed as an absent argument
      if (allocated(record)) then
         call set_factor(record, source%scale, g, error)
      else
         allocate (record)
         call read_record(source%path, source%dt, source%unit, source%scale, g, record, error)
      end if
      if (.not. allocated(error)) return
      ! the path in the key's value may be shortened
      if (source%path /= shown(source%file)) call add_context(error, source%path)
      call add_file(values, group, error)
   end subroutine add_record

   !> Prepend the key of a record file to a message.
   subroutine add_file(values, group, error)
      type(group_values_t), intent(in) :: values
      character(*), intent(in) :: group
      type(error_t), intent(inout) :: error

      call add_context(error, '&'//group//": file = '"//shown(text_of(values, group, 'file')) &
         //"' (line "//trim(integer_to_text(key_line(values, group, 'file')))//')')
   end subroutine add_file

   !> Take the samples of another case if it has read the same file in the same way.
   pure subroutine take_record(known, source, record)
      type(case_t), intent(in) :: known
      class(record_source_t), intent(in) :: source
      type(record_t), allocatable, intent(out) :: record
      !! record whose factor is not yet set

      if (allocated(known%record)) then
         if (is_same_source(known%motion, source)) record = known%record
      end if
      if (allocated(known%upward_record)) then
         if (is_same_source(known%upward, source)) record = known%upward_record
      end if
      if (.not. allocated(record)) return
      ! a changed case has no samples; they stay in the original case
      if (.not. allocated(record%t)) deallocate (record)
   end subroutine take_record

   !> True if both sources read the same file in the same way.
   pure logical function is_same_source(one, other) result(is_same)
      class(record_source_t), intent(in) :: one
      class(record_source_t), intent(in) :: other

      is_same = one%path == other%path &
         .and. (allocated(one%dt) .eqv. allocated(other%dt)) &
         .and. (allocated(one%unit) .eqv. allocated(other%unit))
      if (is_same .and. allocated(one%dt)) is_same = abs(one%dt - other%dt) <= 0
      if (is_same .and. allocated(one%unit)) is_same = one%unit == other%unit
   end function is_same_source

   !> End the simulation with the longest record if `t_end` is absent. Fails with `err_input` if the
   !> simulation would end before it starts.
   subroutine end_with_records(case, error)
      type(case_t), intent(inout) :: case
      !! case with its records; samples are not needed
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: group
      real(wp) :: t_last
      !! last time of the records [s]

      if (has_key(case%values, 'solver', 't_end')) return
      t_last = -huge(t_last)
      if (allocated(case%record)) then
         t_last = case%record%t_last
         group = 'motion'
      end if
      if (allocated(case%upward_record)) then
         if (case%upward_record%t_last > t_last) group = 'vertical'
         t_last = max(t_last, case%upward_record%t_last)
      end if
      if (.not. allocated(group)) return
      case%solver%t_end = t_last
      if (t_last >= 0) return
      call fail(error, err_input, 'the record ends at '//trim(real_to_text(t_last)) &
         //' s, before t = 0: &solver t_end must be given')
      call add_file(case%values, group, error)
   end subroutine end_with_records

end module rwmf_input_reader
