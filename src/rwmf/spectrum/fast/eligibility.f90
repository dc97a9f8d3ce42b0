!> The only list of cases that method 'fast' covers. Any other key or value leaves a case to the
!> general kernel, so that an effect that is new to the program is never ignored.
module rwmf_spectrum_fast_eligibility
   use rwmf_model_effects_list, only: has_effects
   use rwmf_problem_case, only: case_t
   use rwmf_problem_group_values, only: group_values_t
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
      //' spectrum.gamma spectrum.b spectrum.quantities '
   !! keys that the method takes into account, or that do not concern a spectrum

contains

   !> Does the method cover a case? It excludes effects, an initial state, a second run for
   !> `verify`, a requested accuracy or absolute tolerance, and laws and rules not listed here.
   logical function is_supported(case)
      type(case_t), intent(in) :: case

      is_supported = allocated(case%frame) .and. .not. allocated(case%initial) &
         .and. .not. allocated(case%solver%accuracy) &
         .and. .not. case%solver%verify .and. .not. allocated(case%solver%atol)
      if (is_supported) is_supported = .not. has_effects(case)
      if (.not. is_supported) return
      is_supported = is_one_of(case%model%formulation, 'published symmetric exact')
      if (allocated(case%cable)) is_supported = is_supported &
         .and. is_one_of(case%cable%law, 'linear truss')
      if (allocated(case%impact)) is_supported = is_supported &
         .and. is_one_of(case%impact%rule, 'constant housner coupled')
      is_supported = is_supported .and. are_keys_known(case%values)
   end function is_supported

   !> Is a name in a list?
   pure logical function is_one_of(name, names)
      character(*), intent(in) :: name
      character(*), intent(in) :: names
      !! separated by blanks

      is_one_of = index(' '//names//' ', ' '//trim(name)//' ') > 0
   end function is_one_of

   !> Are all keys that a case gives known here?
   logical function are_keys_known(values) result(are_known)
      type(group_values_t), intent(in) :: values
      integer :: i

      are_known = .true.
      if (.not. allocated(values%keys)) return
      do i = 1, size(values%keys)
         if (.not. values%keys(i)%is_given) cycle
         are_known = are_known .and. is_one_of( &
            trim(values%keys(i)%group)//'.'//trim(values%keys(i)%name), known_keys)
      end do
   end function are_keys_known

end module rwmf_spectrum_fast_eligibility
