!> What method 'fast' can compute: the one list. Whatever a case says beyond it is left to the
!> general kernel, so that an effect that is new to the program is never passed over in silence.
module rwmf_spectrum_fast_eligibility
   use rwmf_problem_case, only: case_t
   use rwmf_core_error, only: error_t
   use rwmf_input_namelist, only: group_t, parse_namelist
   use rwmf_input_schema, only: pulse_kinds
   implicit none
   private

   public :: is_supported

   character(*), parameter :: known_keys = ' wall.h wall.b wall.m_w wall.base' &
      //' frame.t_s frame.gamma frame.xi_s cable.eta_0 cable.eta_alpha cable.law' &
      //' impact.rule impact.e impact.r motion.kind motion.a_max_g motion.v_p motion.omega_p' &
      //' motion.t_p motion.cycles motion.t_0 motion.file motion.dt motion.unit motion.scale' &
      //' motion.n_pulses motion.gamma_p motion.nu' &
      //' model.formulation model.g model.overturning_angle' &
      //' solver.method solver.rtol solver.t_end solver.max_steps output.dt output.energy' &
      //' output.reactions output.friction_limit' &
      //' spectrum.t_s spectrum.t_s_min spectrum.t_s_max spectrum.n spectrum.spacing' &
      //' spectrum.gamma spectrum.b '
   !! keys that the lanes heed, or that do not concern a spectrum

contains

   !> Can the lanes compute the scene? Not: an initial state, a second run for `verify`, an accuracy
   !> or absolute tolerance asked for, other bases, laws, rules and groups than those listed here.
   logical function is_supported(case)
      type(case_t), intent(in) :: case

      is_supported = allocated(case%frame) .and. .not. allocated(case%initial) &
         .and. .not. allocated(case%solver%accuracy) &
         .and. .not. allocated(case%link) .and. .not. allocated(case%damper) &
         .and. .not. allocated(case%fuse) .and. .not. allocated(case%inerter) &
         .and. .not. allocated(case%yielding) .and. .not. allocated(case%storeys) &
         .and. .not. allocated(case%vertical) &
         .and. .not. case%solver%verify .and. .not. allocated(case%solver%atol)
      if (.not. is_supported) return
      if (allocated(case%wall)) is_supported = case%wall%base == 'rocking'
      is_supported = is_supported &
         .and. is_one_of(case%model%formulation, 'published symmetric exact')
      if (allocated(case%cable)) is_supported = is_supported &
         .and. is_one_of(case%cable%law, 'linear truss') &
         .and. .not. (allocated(case%cable%eta_y) .or. allocated(case%cable%rupture_strain))
      if (allocated(case%impact)) is_supported = is_supported &
         .and. is_one_of(case%impact%rule, 'constant housner coupled')
      if (allocated(case%motion)) is_supported = is_supported &
         .and. is_one_of(case%motion%kind, 'none '//pulse_kinds//' record')
      if (is_supported .and. allocated(case%text)) is_supported = is_text_known(case%text)
   end function is_supported

   pure logical function is_one_of(name, names)
      character(*), intent(in) :: name
      character(*), intent(in) :: names
      !! separated by blanks

      is_one_of = index(' '//names//' ', ' '//trim(name)//' ') > 0
   end function is_one_of

   !> Are all keys that a case gives known here?
   logical function is_text_known(text) result(is_known)
      character(*), intent(in) :: text
      !! of the namelist file
      type(group_t), allocatable :: groups(:)
      type(error_t), allocatable :: error
      integer :: i, j

      !$omp critical (rwmf_text)
      call parse_namelist(text, groups, error)
      is_known = .not. allocated(error)
      if (is_known) then
         do i = 1, size(groups)
            is_known = is_known .and. index(known_keys, ' '//trim(groups(i)%name)//'.') > 0
            do j = 1, size(groups(i)%entries)
               is_known = is_known .and. is_one_of( &
                  trim(groups(i)%name)//'.'//trim(groups(i)%entries(j)%key), known_keys)
            end do
         end do
      end if
      !$omp end critical (rwmf_text)
   end function is_text_known

end module rwmf_spectrum_fast_eligibility
